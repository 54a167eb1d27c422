#include "core/geometry/closed_form.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace rgbd_pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Noise of one sigma alone produces a stiffness of about 1 per pair. Points
// about three sigmas off a line are needed to determine the rotation about it.
constexpr double kMinStiffnessPerPair = 10.0;

}  // namespace

void PairMoments::Add(const Vector3d& target, const Vector3d& source,
                      double pair_weight) {
  ++count;
  weight += pair_weight;
  const Vector3d from_target_mean = target - target_mean;
  const Vector3d from_source_mean = source - source_mean;
  target_mean += pair_weight / weight * from_target_mean;
  source_mean += pair_weight / weight * from_source_mean;
  const Vector3d weighted_target = pair_weight * (target - target_mean);
  const Vector3d weighted_source = pair_weight * (source - source_mean);
  covariance += weighted_target * from_source_mean.transpose();
  spread += weighted_target.dot(from_target_mean) +
            weighted_source.dot(from_source_mean);
}

NearestRotation::NearestRotation(const Matrix3d& m)
    : rotation(Matrix3d::Identity()), stiffness(0.0) {
  const Eigen::JacobiSVD<Matrix3d> svd(
      m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.info() != Eigen::Success) return;  // m is not finite
  const double sign =
      (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  rotation = svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() *
             svd.matrixV().transpose();
  stiffness = svd.singularValues()[1] + sign * svd.singularValues()[2];
}

std::optional<Rigid3d> UmeyamaAlignment(const PairMoments& moments) {
  if (moments.count < 3) return std::nullopt;
  const NearestRotation nearest(moments.covariance);
  // Written to reject NaN as well, which results from sums that overflow.
  if (!(nearest.stiffness > kMinStiffnessPerPair * moments.count)) {
    return std::nullopt;
  }
  const Eigen::Quaterniond rotation(nearest.rotation);
  return Rigid3d(rotation,
                 moments.target_mean - rotation * moments.source_mean);
}

}  // namespace rgbd_pose
