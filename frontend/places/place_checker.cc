#include "frontend/places/place_checker.h"

#include <optional>
#include <utility>
#include <vector>

#include "core/initial_guess/consensus.h"
#include "core/initial_guess/point_match.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// Of the descriptors that agreed on the rough motion, so many must agree with
// the final one.
constexpr double kMinStillAgree = 0.5;

PlaceCheck Refused(PlaceCheck check, const std::string& reason) {
  check.ok = false;
  check.reason = reason;
  return check;
}

}  // namespace

std::string PlaceCheckerOptions::Check() const {
  if (min_inliers < 3) return "min_inliers must be 3 or more";
  if (!(min_inlier_share >= 0.0 && min_inlier_share <= 1.0)) {
    return "min_inlier_share must be in 0..1";
  }
  if (!(max_sigma > 0.0)) return "max_sigma must be positive";
  return "";
}

PlaceChecker::PlaceChecker(std::unique_ptr<Frontend> frontend,
                           Estimator estimator,
                           const PlaceCheckerOptions& options)
    : frontend_(std::move(frontend)),
      estimator_(std::move(estimator)),
      options_(options),
      matches_{Correspondences(frontend_->options().camera), {}} {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("place checker: " + error);
}

PlaceCheck PlaceChecker::Check(const PlaceFeatures& ref_place,
                               const FeatureSet& ref,
                               const PlaceFeatures& cur_place,
                               const PreparedFrame& cur) {
  const Correspondences described =
      MatchPlaces(ref_place, cur_place, frontend_->options().camera);
  const std::optional<Consensus> rough = FindRoughMotion(described);
  if (!rough.has_value()) {
    return Refused({}, "the descriptors agree on no motion");
  }
  PlaceCheck check = CheckNear(rough->cur_from_prev, ref, cur);
  if (!check.ok) return check;
  std::vector<int> agree;
  FindInliers(PointMatches(described, described.size()), check.cur_from_ref,
              &agree);
  if (agree.size() < kMinStillAgree * rough->inliers.size()) {
    return Refused(std::move(check),
                   Format("only %zu of the %zu descriptors that agreed on a "
                          "motion agree with that of the matches",
                          agree.size(), rough->inliers.size()));
  }
  return check;
}

PlaceCheck PlaceChecker::CheckNear(const Rigid3d& cur_from_ref_guess,
                                   const FeatureSet& ref,
                                   const PreparedFrame& cur) {
  frontend_->Match(ref, cur, cur_from_ref_guess, &matches_);
  PairData pair;
  pair.matches = &matches_.matches;
  estimator_.Estimate(pair, cur_from_ref_guess, &estimate_);
  PlaceCheck check;
  check.cur_from_ref = estimate_.cur_from_prev;
  check.covariance = estimate_.covariance;
  check.num_matches = static_cast<int>(matches_.matches.size());
  check.num_inliers = estimate_.num_inliers;
  check.sigma = estimate_.sigma;
  if (!estimate_.ok()) return Refused(std::move(check), estimate_.reason);
  if (check.num_inliers < options_.min_inliers ||
      check.num_inliers < options_.min_inlier_share * check.num_matches) {
    return Refused(std::move(check),
                   Format("only %d of %d matches agree", check.num_inliers,
                          check.num_matches));
  }
  if (check.sigma > options_.max_sigma) {
    return Refused(std::move(check),
                   Format("residuals spread by %.1f sigmas", check.sigma));
  }
  check.ok = true;
  return check;
}

}  // namespace rgbd_pose
