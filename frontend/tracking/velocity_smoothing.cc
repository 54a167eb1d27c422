#include "frontend/tracking/velocity_smoothing.h"

#include <Eigen/Cholesky>

namespace rgbd_pose {

SmoothedFrame Smooth(const TwistEstimate& found,
                     const MotionMatrix& motion_covariance,
                     const MeanVelocity& mean) {
  const double per_second = 1.0 / mean.seconds;
  const Twist off = mean.twist - found.twist;
  MotionVector innovation;
  innovation << off.angular, off.linear;
  const MotionMatrix spread = found.covariance + mean.covariance +
                              per_second * per_second * motion_covariance;
  const Eigen::LDLT<MotionMatrix> solver(spread);
  const MotionVector weighted = solver.solve(innovation);
  const MotionVector turn = found.covariance * weighted;
  // A Twist is the velocity of the camera, which moves points the other way:
  // hence the sign of the second part.
  const MotionMatrix cross =
      found.motion_by_twist * found.covariance + per_second * motion_covariance;
  return {found.twist + Twist{turn.head<3>(), turn.tail<3>()},
          found.covariance - found.covariance * solver.solve(found.covariance),
          cross * weighted};
}

MotionMatrix CovarianceInCurrentAxes(const MotionEstimate& estimate,
                                     const TwistEstimate* velocity) {
  MotionMatrix covariance = estimate.covariance;
  if (velocity != nullptr) covariance -= velocity->motion_covariance;
  MotionMatrix from_center = MotionMatrix::Identity();
  from_center.bottomRightCorner<3, 3>() =
      -estimate.cur_from_prev.rotation.toRotationMatrix();
  return from_center * covariance * from_center.transpose();
}

}  // namespace rgbd_pose
