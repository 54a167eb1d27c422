#include "core/factors/sqrt_information.h"

#include <Eigen/LU>
#include <cmath>

#include "core/util/input_error.h"

namespace rgbd_pose {

SmallMatrix SqrtInformation(const SmallMatrix& information) {
  const SmallMatrix none =
      SmallMatrix::Constant(information.rows(), information.cols(), NAN);
  if (!information.allFinite()) return none;
  // However small all entries are, one on the diagonal is below 0 by no more
  // than rounding.
  constexpr double kRounding = 1e-12;
  if (information.diagonal().minCoeff() <
      -kRounding * information.diagonal().maxCoeff()) {
    return none;
  }
  // Scaled first: rotation and translation differ by orders of magnitude.
  const Eigen::VectorXd size =
      information.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr(
          [](double value) { return value > 0.0 ? value : 1.0; });
  const auto eigen = EigenOf(size.cwiseInverse().asDiagonal() * information *
                             size.cwiseInverse().asDiagonal());
  // Rounding changes zero eigenvalues by about 1e-16.
  if (eigen.eigenvalues().minCoeff() < -1e-9) return none;
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose() * size.asDiagonal();
}

SmallMatrix SqrtInformationOfCovariance(const SmallMatrix& covariance) {
  constexpr double kRounding = 1e-9;
  if (!covariance.allFinite()) throw InputError("a covariance is not finite");
  const SmallMatrix S = SqrtInformation(covariance.inverse());
  if (!covariance.isApprox(covariance.transpose(), kRounding)) {
    throw InputError("a covariance is not symmetric");
  }
  if (!S.allFinite()) {
    throw InputError("a covariance is not positive definite");
  }
  return S;
}

}  // namespace rgbd_pose
