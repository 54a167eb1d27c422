#include "core/alignment.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace rgbd_pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// How much the orientation of the first pair counts against the spread of the
// positions: enough to outweigh their rounding errors, too little to turn a
// rotation that they determine (by about 1e-9 rad).
constexpr double kShareOfSpread = 1e-9;
constexpr double kLeastSpread = 1e-18;  // m^2 a pair: a spread of 1 nm

// The rotation R that maximises trace(R^T m).
Matrix3d NearestRotation(const Matrix3d& m) {
  const Eigen::JacobiSVD<Matrix3d> svd(
      m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign =
      (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() *
         svd.matrixV().transpose();
}

}  // namespace

Rigid3d AlignRigidly(const std::vector<PosePair>& pairs) {
  Vector3d truth_mean = Vector3d::Zero();
  Vector3d estimate_mean = Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    truth_mean += pair.truth.translation / pairs.size();
    estimate_mean += pair.estimate.translation / pairs.size();
  }

  Matrix3d covariance = Matrix3d::Zero();
  double spread = 0.0;
  for (const PosePair& pair : pairs) {
    const Vector3d truth = pair.truth.translation - truth_mean;
    const Vector3d estimate = pair.estimate.translation - estimate_mean;
    covariance += truth * estimate.transpose();
    spread += truth.squaredNorm() + estimate.squaredNorm();
  }

  const Eigen::Quaterniond first =
      pairs[0].truth.rotation * pairs[0].estimate.rotation.conjugate();
  const double weight = kShareOfSpread * spread + kLeastSpread * pairs.size();
  const Eigen::Quaterniond rotation(
      NearestRotation(covariance + weight * first.toRotationMatrix()));
  return Rigid3d(rotation, truth_mean - rotation * estimate_mean);
}

}  // namespace rgbd_pose
