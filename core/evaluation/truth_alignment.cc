#include "core/evaluation/truth_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/evaluation/alignment.h"
#include "core/evaluation/association.h"
#include "core/util/format.h"

namespace rgbd_pose {
namespace {

// Compares trajectories, which must outlive it, under any fixing of the truth.
class TruthComparison {
 public:
  // Of the compared motions: they outweigh noise, but drift does not count.
  static constexpr double kMotionSeconds = 0.2;

  TruthComparison(const Trajectory& estimate, const Trajectory& ground_truth)
      : estimate_(estimate), truth_(ground_truth), times_(TimesOf(estimate)) {
    std::vector<std::optional<Rigid3d>> poses;
    for (const StampedPose& pose : estimate) {
      poses.emplace_back(pose.world_from_cam);
    }
    moving_estimate_ = MovingPoses(times_, poses);
    constexpr double kMotionTolerance = 0.05;  // s
    constexpr size_t kMaxMotions = 20000;
    const std::vector<PoseInterval> all =
        TimeIntervals(times_, kMotionSeconds, kMotionTolerance);
    const size_t step = all.size() / kMaxMotions + 1;
    for (size_t i = 0; i < all.size(); i += step) intervals_.push_back(all[i]);
  }

  // Motions for which the truth is known, in time order.
  std::vector<ComparedMotion> Motions(const TruthFixing& fixing) const {
    const auto truth = MovingPoses(times_, Truth(fixing));
    const auto& estimate = moving_estimate_;
    std::vector<ComparedMotion> motions;
    for (const auto& [i, j] : intervals_) {
      if (!estimate[i] || !estimate[j] || !truth[i] || !truth[j]) continue;
      motions.push_back({times_[i], PoseChange(*estimate[i], *estimate[j]),
                         PoseChange(*truth[i], *truth[j])});
    }
    return motions;
  }

  // Poses of the estimate and of the camera according to the truth.
  std::vector<PosePair> Pairs(const TruthFixing& fixing) const {
    const std::vector<std::optional<Rigid3d>> truth = Truth(fixing);
    std::vector<PosePair> pairs;
    for (size_t i = 0; i < truth.size(); ++i) {
      if (!truth[i].has_value()) continue;
      pairs.push_back({times_[i], *truth[i], estimate_[i].world_from_cam});
    }
    return pairs;
  }

 private:
  // Poses of the camera according to the truth, at the times of the estimate.
  std::vector<std::optional<Rigid3d>> Truth(const TruthFixing& fixing) const {
    const Rigid3d body_from_camera = fixing.camera_from_body.Inverse();
    std::vector<std::optional<Rigid3d>> poses;
    for (const double time : times_) {
      poses.push_back(InterpolatedPose(truth_, time + fixing.shift));
      if (poses.back()) poses.back() = *poses.back() * body_from_camera;
    }
    return poses;
  }

  const Trajectory& estimate_;
  const Trajectory& truth_;
  std::vector<double> times_;  // of the estimate, s
  std::vector<std::optional<MovingPose>> moving_estimate_;
  std::vector<PoseInterval> intervals_;
};

constexpr int kMinMotions = 30;

constexpr double kMaxShift = 0.5;       // s
constexpr double kMaxShiftStep = 0.05;  // s; hand motion changes this fast

// While the fixing is far off, motions seem to contain little information: the
// first rounds use kFirstLimit only. Directions are frozen after the open ones.
constexpr int kRounds = 40;
constexpr int kOpenRounds = 20;
constexpr int kFirstRounds = 10;
constexpr double kFirstLimit = 10.0;  // of FixingUnits

// Noise alone has a correlation of about 0.2 in ten seconds.
constexpr double kMinAgreement = 0.5;
constexpr double kConverged = 1e-4;  // of FixingUnits

// A parameter counts as open if more than this share of it is undetermined.
constexpr double kMaxOpenShare = 0.1;

// Sigmas along `directions`, in FixingUnits; infinite with a share in `rest`.
FixingVector SigmaOf(const FixingEquations& equations,
                     const FixingDirections& directions,
                     const FixingDirections& rest) {
  FixingMatrix covariance = FixingMatrix::Zero();
  if (directions.cols() > 0) {
    const Eigen::MatrixXd hessian =
        directions.transpose() * equations.hessian * directions;
    const Eigen::MatrixXd to_step =
        directions * hessian.ldlt().solve(directions.transpose());
    covariance = to_step * equations.GradientCovariance() * to_step.transpose();
  }
  FixingVector sigma;
  for (int i = 0; i < sigma.size(); ++i) {
    const bool is_open =
        rest.cols() > 0 && rest.row(i).squaredNorm() > kMaxOpenShare;
    sigma[i] = is_open ? INFINITY : std::sqrt(std::max(0.0, covariance(i, i)));
  }
  return sigma;
}

// Gauss-Newton within the determined directions; the parameters are zero in the
// others. Counts motions. Returns the reason of a failure, or empty.
std::string FindFixing(const TruthComparison& comparison,
                       TruthAlignment* result) {
  FixingVector x = FixingVector::Zero();
  FixingDirections directions;
  FixingDirections rest;
  for (int round = 0;; ++round) {
    const TruthFixing fixing = FixingAt(x);
    const FixingEquations equations(comparison.Motions(fixing),
                                    fixing.camera_from_body.translation,
                                    TruthComparison::kMotionSeconds);
    result->motions = equations.used();
    if (equations.used() < kMinMotions) {
      return Format(
          "only %d motions of %g s can be compared with the ground truth (its "
          "poses must be less than 50 ms apart); at least %d are needed",
          equations.used(), TruthComparison::kMotionSeconds, kMinMotions);
    }
    if (round < kOpenRounds) {
      const bool first = round < kFirstRounds;
      directions = equations.Determined(first ? kFirstLimit : 1.0,
                                        first ? 0.0 : kMinAgreement, &rest);
    }
    FixingVector next = FixingVector::Zero();
    if (directions.cols() > 0) {
      const Eigen::MatrixXd hessian =
          directions.transpose() * equations.hessian * directions;
      next = directions *
             hessian.ldlt().solve(directions.transpose() *
                                  (equations.hessian * x + equations.gradient));
    }
    const double step = kMaxShiftStep / FixingUnits()[0];
    const double limit = kMaxShift / FixingUnits()[0];
    next[0] = std::clamp(std::clamp(next[0], x[0] - step, x[0] + step), -limit,
                         limit);
    const double change = (next - x).norm();
    x = next;
    if ((round >= kOpenRounds && change < kConverged) || round + 1 == kRounds) {
      if (std::abs(x[0]) >= limit) {
        return Format("no time shift of less than %g s fits", kMaxShift);
      }
      result->fixing = FixingAt(x);
      result->undetermined = NameFixingDirections(rest);
      result->sigma =
          SigmaOf(equations, directions, rest).cwiseProduct(FixingUnits());
      return "";
    }
  }
}

}  // namespace

TruthAlignment AlignTruth(const Trajectory& estimate,
                          const Trajectory& ground_truth,
                          double rpe_delta_seconds,
                          double max_time_difference) {
  TruthAlignment result;
  const TruthComparison comparison(estimate, ground_truth);
  result.skipped = FindFixing(comparison, &result);
  if (!result.skipped.empty()) return result;
  const std::vector<PosePair> pairs = comparison.Pairs(result.fixing);
  const Rigid3d truth_from_estimate = AlignRigidly(pairs);
  std::vector<double> distances;
  for (const PosePair& pair : pairs) {
    distances.push_back((truth_from_estimate * pair.estimate.translation -
                         pair.truth.translation)
                            .norm());
  }
  result.ate = Summarise(std::move(distances));
  result.rpe_seconds = SummariseIntervals(
      pairs,
      TimeIntervals(TimesOf(pairs), rpe_delta_seconds, max_time_difference));
  return result;
}

}  // namespace rgbd_pose
