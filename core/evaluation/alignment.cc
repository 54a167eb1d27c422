#include "core/evaluation/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/geometry/closed_form.h"
#include "core/util/format.h"

namespace rgbd_pose {
namespace {

// Weight of the first pair's orientation relative to the spread of the
// positions: more than their rounding errors, less than what they determine.
constexpr double kShareOfSpread = 1e-9;
constexpr double kLeastSpread = 1e-18;  // m^2 per pair: a spread of 1 nm

// A scale is reported if it leaves at most this share of the error.
constexpr double kExplained = 0.5;

// A larger share left means other motions, a smaller true spread (m) noise.
constexpr double kMaxRest = 0.7;
constexpr double kMinSpread = 0.05;

}  // namespace

Rigid3d AlignRigidly(const std::vector<PosePair>& pairs) {
  PairMoments moments;
  for (const PosePair& pair : pairs) {
    moments.Add(pair.truth.translation, pair.estimate.translation);
  }
  const Eigen::Quaterniond first =
      pairs[0].truth.rotation * pairs[0].estimate.rotation.conjugate();
  const double weight =
      kShareOfSpread * moments.spread + kLeastSpread * moments.count;
  const Eigen::Quaterniond rotation(
      NearestRotation(moments.covariance + weight * first.toRotationMatrix())
          .rotation);
  return Rigid3d(rotation,
                 moments.target_mean - rotation * moments.source_mean);
}

Sim3Alignment Compare(const std::vector<PosePair>& pairs,
                      const Rigid3d& truth_from_estimate) {
  Eigen::Vector3d true_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    true_mean += pair.truth.translation;
    mean += truth_from_estimate * pair.estimate.translation;
  }
  const auto count = static_cast<double>(pairs.size());
  true_mean /= count;
  mean /= count;
  double both = 0.0;
  double of_truth = 0.0;
  double of_estimate = 0.0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d truth = pair.truth.translation - true_mean;
    const Eigen::Vector3d estimate =
        truth_from_estimate * pair.estimate.translation - mean;
    both += truth.dot(estimate);
    of_truth += truth.squaredNorm();
    of_estimate += estimate.squaredNorm();
  }
  Sim3Alignment sim3;
  // Rounding errors alone do not determine a scale.
  if (of_estimate > 1e-12 * of_truth && both > 0.0) {
    sim3.truth_per_estimate = both / of_estimate;
  }
  const double scale = sim3.truth_per_estimate;
  const double rest =
      of_truth - 2.0 * scale * both + scale * scale * of_estimate;
  sim3.spread = std::sqrt(of_truth / count);
  sim3.residual_rmse = std::sqrt(std::max(0.0, rest) / count);
  return sim3;
}

std::string Sim3Warning(const Sim3Alignment& sim3, double ate) {
  if (sim3.spread < kMinSpread) return "";
  if (sim3.residual_rmse > kMaxRest * sim3.spread) {
    return Format(
        "the path does not match the ground truth (%.3g m apart on average, "
        "for an extent of %.3g m); check that the ground truth belongs to this "
        "recording and uses the same clock",
        sim3.residual_rmse, sim3.spread);
  }
  const double scale = sim3.truth_per_estimate;
  if (std::abs(scale - 1.0) <= 0.1 || sim3.residual_rmse > kExplained * ate) {
    return "";
  }
  return Format(
      "the path fits the ground truth better if scaled by %.4g; likely causes "
      "are the depth scale (%.4g times the one used would fit) and the focal "
      "length",
      scale, 1.0 / scale);
}

}  // namespace rgbd_pose
