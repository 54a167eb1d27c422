#include "core/evaluation/consistency.h"

#include <optional>

#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// The true pose of a frame; nothing if it is not among `times` or unknown.
std::optional<Rigid3d> TruePose(int frame, const std::vector<double>& times,
                                const Trajectory& truth) {
  if (frame < 0 || frame >= static_cast<int>(times.size())) return std::nullopt;
  return InterpolatedPose(truth, times[frame]);
}

}  // namespace

double ChiSquare(const RelativePose& edge, const Rigid3d& true_cur_from_ref,
                 const TruthNoise& noise) {
  MotionMatrix covariance = edge.covariance;
  covariance.diagonal().head<3>().array() += noise.rotation * noise.rotation;
  covariance.diagonal().tail<3>().array() +=
      noise.translation * noise.translation;
  return SquaredMahalanobisDistance(true_cur_from_ref, edge.cur_from_ref,
                                    covariance);
}

Consistency Judge(const std::vector<RelativePose>& edges,
                  const std::vector<double>& times, const Trajectory& truth,
                  const TruthNoise& noise) {
  Consistency result;
  std::vector<double> shares;
  for (const RelativePose& edge : edges) {
    if (edge.covariance.isZero(0.0)) continue;  // no covariance
    const std::optional<Rigid3d> ref = TruePose(edge.ref, times, truth);
    const std::optional<Rigid3d> cur = TruePose(edge.cur, times, truth);
    if (!ref.has_value() || !cur.has_value()) continue;
    const double chi_square = ChiSquare(edge, cur->Inverse() * *ref, noise);
    // Negated to count invalid covariances (NaN) as wrong, too.
    result.wrong += !(chi_square >= 0.0 && chi_square <= kWrongChiSquare);
    shares.push_back(chi_square / 6.0);  // degrees of freedom
    result.nees += shares.back();
  }
  if (shares.empty()) return result;
  result.count = static_cast<int>(shares.size());
  result.nees /= result.count;
  result.median = QuantileInPlace(&shares, 0.5);
  return result;
}

}  // namespace rgbd_pose
