#include <algorithm>
#include <cmath>

#include "core/util/quantile.h"
#include "frontend/slam/keyframe_graph.h"
#include "robust/m_estimator.h"

// This file has the uncertainty of pairs: their covariance, a noise floor, and
// an error proportional to the motion, which is caused by an inaccurate
// calibration.

namespace rgbd_pose {
namespace {

// Widths of the loss functions, in sigmas. Pairs of the odometry are hardly
// ever wrong. Most others agree within one or two sigmas, but some between
// distant views are up to ten sigmas too short and would shrink the map.
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

KeyframeGraph::KeyframeGraph(int window, double drift)
    : window_(window),
      drift_(drift),
      tracked_loss_(FindNamed(MEstimators(), "huber")->make(kTrackedWidth)),
      pair_loss_(FindNamed(MEstimators(), "cauchy")->make(kPairWidth)) {}

MotionMatrix KeyframeGraph::CovarianceOf(const RelativePose& edge) const {
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

MotionMatrix KeyframeGraph::CovarianceInGraph(const MapEdge& pair) const {
  // Errors of tracked pairs cancel in part along a path: what is wrong with a
  // keyframe affects the pair that ends with it and the pair that begins with
  // it. This share of the covariance remains, as measured on paths of real
  // cameras with a ground truth.
  constexpr double kRemaining = 0.5;
  RelativePose edge = pair;
  if (pair.is_tracked) edge.covariance *= kRemaining;
  return CovarianceOf(edge);
}

double KeyframeGraph::SquaredDistance(const RelativePose& edge,
                                      const MotionMatrix& covariance) const {
  return SquaredMahalanobisDistance(CurFromRef(edge.ref, edge.cur),
                                    edge.cur_from_ref, covariance);
}

MotionMatrix KeyframeGraph::CovarianceAsSolved(const MapEdge& pair) const {
  const MotionMatrix covariance = CovarianceInGraph(pair);
  double rho[3];
  LossOf(pair)->Evaluate(SquaredDistance(pair, covariance), rho);
  return covariance / std::max(rho[1], 1e-9);
}

// The proportional error is fitted so that the median disagreement between the
// pairs and the current poses is as expected from the covariances. Tracked
// pairs are ignored, as the poses follow them too closely.
void KeyframeGraph::FitProportionalError() {
  const auto disagree = [this] {
    std::vector<double> squares;
    for (const MapEdge& pair : pairs_) {
      if (pair.is_tracked) continue;
      squares.push_back(SquaredDistance(pair, CovarianceOf(pair)));
    }
    return squares.size() >= kMinPairsForProportionalError &&
           QuantileInPlace(&squares, 0.5) > kMedianSquare;
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
bool KeyframeGraph::PassesMahalanobisGate(const RelativePose& edge) const {
  const std::vector<int> path = links_.ShortestPath(edge.ref, edge.cur);
  if (path.empty()) return false;
  double way = 0.0, turns = 0.0;
  const size_t pairs = path.size() - 1;
  for (size_t i = pairs; i > 0; --i) {
    const Rigid3d step = CurFromRef(path[i - 1], path[i]);
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
  return SquaredMahalanobisDistance(edge.cur_from_ref,
                                    CurFromRef(edge.ref, edge.cur),
                                    covariance) < kLargestSquare;
}

}  // namespace rgbd_pose
