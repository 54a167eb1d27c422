#include "apps/pipeline/pair_trust.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

// Losses of pairs, in sigmas. The odometry's own are hardly ever wrong. Of the
// others most agree within a sigma or two, but some of those between views from
// far aside are up to ten sigmas too short: together they would shrink the map.
constexpr double kTrackedWidth = 5.0;
constexpr double kPairWidth = 2.0;

// A wrong rotation displaces what is seen at this distance (m).
constexpr double kTypicalDepth = 2.0;

// The median of chi^2 of six degrees, and its 99.9 % quantile.
constexpr double kMedianSquare = 5.35;
constexpr double kLargestSquare = 22.46;

// Slack is measured by so many pairs at least.
constexpr int kMinPairsForSlack = 20;
constexpr double kMaxSlack = 0.1;

// Of a motion against another: omega (rad) about the current axes, and C (m).
MotionVector Difference(const Rigid3d& motion, const Rigid3d& other) {
  const Eigen::AngleAxisd omega(motion.rotation * other.rotation.conjugate());
  MotionVector e;
  e << omega.angle() * omega.axis(),
      motion.Inverse().translation - other.Inverse().translation;
  return e;
}

double SquaredSigmas(const MotionVector& e, const MotionMatrix& covariance) {
  return e.dot(covariance.ldlt().solve(e));
}

}  // namespace

std::string PairTrustOptions::Check() const {
  if (!(min_sigma_rotation >= 0.0) || !(min_sigma_translation >= 0.0)) {
    return "standard deviations must not be negative";
  }
  if (!(drift > 0.0)) return "drift must be positive";
  return "";
}

PairTrust::PairTrust(const PairTrustOptions& options)
    : options_(options),
      tracked_loss_(FindMEstimator("huber")->make(kTrackedWidth)),
      pair_loss_(FindMEstimator("cauchy")->make(kPairWidth)) {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("graph: " + error);
}

MotionMatrix PairTrust::CovarianceOf(const Edge& edge, double slack) const {
  MotionMatrix covariance = edge.covariance;
  const double angle = edge.cur_from_ref.Angle();
  const double way =
      edge.cur_from_ref.translation.norm() + kTypicalDepth * angle;
  covariance.diagonal().head<3>().array() +=
      std::pow(options_.min_sigma_rotation, 2) + std::pow(slack * angle, 2);
  covariance.diagonal().tail<3>().array() +=
      std::pow(options_.min_sigma_translation, 2) + std::pow(slack * way, 2);
  return covariance;
}

MotionMatrix PairTrust::CovarianceOf(const Edge& edge) const {
  return CovarianceOf(edge, slack_);
}

const ceres::LossFunction* PairTrust::LossOf(const KeyframePair& pair) const {
  return pair.is_tracked ? tracked_loss_.get() : pair_loss_.get();
}

MotionMatrix PairTrust::CovarianceAsSolved(const KeyframePair& pair,
                                           const Rigid3d& cur_from_ref) const {
  const MotionMatrix covariance = CovarianceOf(pair.edge);
  const MotionVector e = Difference(cur_from_ref, pair.edge.cur_from_ref);
  double rho[3];
  LossOf(pair)->Evaluate(SquaredSigmas(e, covariance), rho);
  return covariance / std::max(rho[1], 1e-9);
}

void PairTrust::FitSlack(const std::vector<KeyframePair>& pairs,
                         const std::vector<Rigid3d>& cur_from_ref) {
  const auto median = [&](double slack) {
    std::vector<double> squares;
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (pairs[i].is_tracked) continue;
      const Edge& edge = pairs[i].edge;
      squares.push_back(
          SquaredSigmas(Difference(cur_from_ref[i], edge.cur_from_ref),
                        CovarianceOf(edge, slack)));
    }
    return Median(squares);
  };
  slack_ = 0.0;
  const auto found = std::count_if(pairs.begin(), pairs.end(),
                                   [](const auto& p) { return !p.is_tracked; });
  if (found < kMinPairsForSlack || median(0.0) <= kMedianSquare) return;
  double low = 0.0, high = kMaxSlack;
  for (int step = 0; step < 12; ++step) {
    const double middle = 0.5 * (low + high);
    (median(middle) > kMedianSquare ? low : high) = middle;
  }
  slack_ = high;
}

// Along a way errors add up, and an error of the rotation swings all that
// follows.
bool PairTrust::IsPlausible(const Edge& edge,
                            const std::vector<Rigid3d>& map_from_cam) const {
  double way = 0.0, turns = 0.0;
  const size_t pairs = map_from_cam.size() - 1;
  for (size_t i = pairs; i > 0; --i) {
    const Rigid3d step = map_from_cam[i].Inverse() * map_from_cam[i - 1];
    way += step.translation.norm();
    turns += step.Angle();
  }
  const double drift = std::max(options_.drift, slack_);
  const double rotation = pairs * std::pow(options_.min_sigma_rotation, 2) +
                          std::pow(drift * turns, 2);
  const double translation =
      pairs * std::pow(options_.min_sigma_translation, 2) +
      std::pow(drift * way, 2) + rotation * way * way / 3.0;
  MotionMatrix covariance = CovarianceOf(edge);
  covariance.diagonal().head<3>().array() += rotation;
  covariance.diagonal().tail<3>().array() += translation;
  const Rigid3d along = map_from_cam.back().Inverse() * map_from_cam.front();
  return SquaredSigmas(Difference(edge.cur_from_ref, along), covariance) <
         kLargestSquare;
}

}  // namespace rgbd_pose
