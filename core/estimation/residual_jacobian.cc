#include "core/estimation/residual_jacobian.h"

#include <vector>

#include "core/geometry/motion.h"

namespace rgbd_pose {

ResidualJacobian DifferenceJacobian(const MotionCost& cost,
                                    const Rigid3d& cur_from_prev) {
  constexpr double kStep = 1e-6;  // rad and m
  const LinearizationPoint origin(cur_from_prev);
  std::vector<double> here, moved;
  cost.Residuals(DerivativesAt(cur_from_prev), &here);
  const auto rows = static_cast<Eigen::Index>(here.size());
  ResidualJacobian jacobian(rows, 6);
  for (int column = 0; column < 6; ++column) {
    MotionVector x = MotionVector::Zero();
    x[column] = kStep;
    cost.Residuals(origin.DerivativesAt(x.data()), &moved);
    jacobian.col(column) = (Eigen::Map<Eigen::VectorXd>(moved.data(), rows) -
                            Eigen::Map<Eigen::VectorXd>(here.data(), rows)) /
                           kStep;
  }
  return jacobian;
}

}  // namespace rgbd_pose
