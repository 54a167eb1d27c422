#include "frontend/mapping/edge_noise_model.h"

#include <algorithm>
#include <cmath>

#include "core/util/quantile.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

// Widths of the loss functions, in sigmas. Pairs of the odometry are hardly
// ever wrong. Most others agree within one or two sigmas, but some motions
// between distant views are up to ten sigmas too short and would shrink the
// map.
constexpr double kTrackedWidth = 5.0;
constexpr double kPairWidth = 2.0;

// Depth at which a wrong rotation is converted to a displacement, m.
constexpr double kTypicalDepth = 2.0;

// Noise floor of a pair by effects not in noise models (calibration, stamps).
constexpr double kMinSigmaRotation = 1e-4;       // rad
constexpr double kMinSigmaTranslation = 2.5e-4;  // m

// Median and 99.9 % quantile of chi^2 with six degrees of freedom.
constexpr double kMedianSquare = 5.35;
constexpr double kLargestSquare = 22.46;

// Minimum number of pairs to fit the proportional error, and its maximum.
constexpr size_t kMinPairsForProportionalError = 20;
constexpr double kMaxProportionalError = 0.1;

}  // namespace

EdgeNoiseModel::EdgeNoiseModel(double drift)
    : drift_(drift),
      tracked_loss_(FindMEstimator("huber")->make(kTrackedWidth)),
      pair_loss_(FindMEstimator("cauchy")->make(kPairWidth)) {}

MotionMatrix EdgeNoiseModel::CovarianceOf(const RelativePose& edge) const {
  MotionMatrix covariance = edge.covariance;
  const double angle = edge.cur_from_ref.Angle();
  const double way =
      edge.cur_from_ref.translation.norm() + kTypicalDepth * angle;
  covariance.diagonal().head<3>().array() +=
      std::pow(kMinSigmaRotation, 2) + std::pow(proportional_error_ * angle, 2);
  covariance.diagonal().tail<3>().array() +=
      std::pow(kMinSigmaTranslation, 2) +
      std::pow(proportional_error_ * way, 2);
  return covariance;
}

MotionMatrix EdgeNoiseModel::CovarianceAsSolved(
    const KeyframePair& pair, const Rigid3d& cur_from_ref) const {
  const MotionMatrix covariance = CovarianceOf(pair.edge);
  double rho[3];
  LossOf(pair)->Evaluate(SquaredMahalanobisDistance(
                             cur_from_ref, pair.edge.cur_from_ref, covariance),
                         rho);
  return covariance / std::max(rho[1], 1e-9);
}

void EdgeNoiseModel::FitProportionalError(
    const std::vector<KeyframePair>& pairs,
    const std::vector<Rigid3d>& cur_from_ref) {
  const auto disagree = [&] {
    std::vector<double> squares;
    for (size_t i = 0; i < pairs.size(); ++i) {
      const RelativePose& edge = pairs[i].edge;
      if (pairs[i].is_tracked) continue;
      squares.push_back(SquaredMahalanobisDistance(
          cur_from_ref[i], edge.cur_from_ref, CovarianceOf(edge)));
    }
    return squares.size() >= kMinPairsForProportionalError &&
           Median(squares) > kMedianSquare;
  };
  proportional_error_ = 0.0;
  if (!disagree()) return;
  double low = 0.0, high = kMaxProportionalError;
  for (int step = 0; step < 12; ++step) {
    proportional_error_ = 0.5 * (low + high);
    (disagree() ? low : high) = proportional_error_;
  }
  proportional_error_ = high;
}

// Errors add up along a path, and a wrong rotation displaces all that follows.
bool EdgeNoiseModel::PassesMahalanobisGate(
    const RelativePose& edge, const std::vector<Rigid3d>& map_from_cam) const {
  double way = 0.0, turns = 0.0;
  const size_t pairs = map_from_cam.size() - 1;
  for (size_t i = pairs; i > 0; --i) {
    const Rigid3d step = map_from_cam[i].Inverse() * map_from_cam[i - 1];
    way += step.translation.norm();
    turns += step.Angle();
  }
  const double drift = std::max(drift_, proportional_error_);
  const double rotation =
      pairs * std::pow(kMinSigmaRotation, 2) + std::pow(drift * turns, 2);
  const double translation = pairs * std::pow(kMinSigmaTranslation, 2) +
                             std::pow(drift * way, 2) +
                             rotation * way * way / 3.0;
  MotionMatrix covariance = CovarianceOf(edge);
  covariance.diagonal().head<3>().array() += rotation;
  covariance.diagonal().tail<3>().array() += translation;
  const Rigid3d along = map_from_cam.back().Inverse() * map_from_cam.front();
  return SquaredMahalanobisDistance(edge.cur_from_ref, along, covariance) <
         kLargestSquare;
}

}  // namespace rgbd_pose
