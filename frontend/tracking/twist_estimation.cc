#include "frontend/tracking/twist_estimation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Vector12 = Eigen::Matrix<double, 12, 1>;

// Width of the Cauchy loss, in sigmas.
constexpr double kLossWidth = 2.0;

// Depth is not used if a surface is seen at a flatter angle than this (about
// the cosine between viewing ray and normal, which points to the camera).
constexpr double kFlattest = -0.2;

double Weight(double square, double sigma) {
  return 1.0 / (sigma * sigma *
                (1.0 + square / (sigma * sigma * kLossWidth * kLossWidth)));
}

}  // namespace

TwistEstimate ExpectedTwist(const FrameTiming& timing,
                            const VelocityPrior& prior) {
  const double sigma_angular = prior.SigmaAngular();
  const double sigma_linear = prior.SigmaLinear();
  return {timing.twist, IndependentErrors(sigma_angular, sigma_linear),
          timing.color.offset * MotionMatrix::Identity(),
          MotionCovarianceOfTwist(timing, sigma_angular, sigma_linear)};
}

TwistEstimate EstimateTwist(const Correspondences& matches,
                            const std::vector<bool>& is_inlier, double sigma,
                            const Rigid3d& cur_from_ref,
                            const FrameTiming& timing, const Twist& prior_mean,
                            const VelocityPrior& prior) {
  // Errors not covered by the noise model are no smaller here.
  const double spread = std::max(1.0, sigma);
  const Camera& camera = matches.camera();
  // Normal equations of the change of the motion (rotation, then translation,
  // in current axes) and the change of the velocity (angular, then linear).
  Matrix12 hessian = Matrix12::Zero();
  Vector12 right = Vector12::Zero();
  // Adds a residual with its derivatives by both changes.
  const auto add = [&](const MotionVector& by_motion,
                       const MotionVector& by_velocity, double residual,
                       double weight) {
    Vector12 both;
    both << by_motion, by_velocity;
    hessian.noalias() += both * (weight * both).transpose();
    right -= weight * residual * both;
  };
  for (size_t i = 0; i < matches.size(); ++i) {
    const auto& [ref, cur] = matches[i];
    if (!is_inlier[i] || ref.depth <= 0.0) continue;
    const Eigen::Vector3d point = cur_from_ref * matches.Point(ref);
    if (!(point.z() > 0.0)) continue;
    const double inverse = 1.0 / point.z();
    const double x = point.x() * inverse, y = point.y() * inverse;
    // Derivatives of x, y and z by the motion.
    MotionVector by_x, by_y, by_z;
    by_x << -x * y, 1.0 + x * x, -y, inverse, 0.0, -x * inverse;
    by_y << -1.0 - y * y, x * y, x, 0.0, inverse, -y * inverse;
    by_z << point.y(), -point.x(), 0.0, 0.0, 0.0, 1.0;
    // The row in which the point was seen, up to some pixels.
    const double row = cur.v;
    const double u = camera.fx * x + camera.cx - cur.u;
    const double v = camera.fy * y + camera.cy - cur.v;
    const double weight =
        Weight(u * u + v * v, spread * std::hypot(ref.sigma_px, cur.sigma_px));
    // For a point seen `seen` seconds after the stamp, a change of the velocity
    // acts like a motion in the opposite direction for this time.
    const double seen = timing.color.RowTime(row, camera.height);
    add(camera.fx * by_x, -seen * camera.fx * by_x, u, weight);
    add(camera.fy * by_y, -seen * camera.fy * by_y, v, weight);
    if (cur.depth <= 0.0) continue;
    // Between the colour and the depth exposure the surface moves along the
    // viewing ray; how far depends on its slope.
    const double since = timing.depth.RowTime(row, camera.height) - seen;
    MotionVector along_ray = MotionVector::Zero();
    if (since != 0.0) {
      const double slope = cur.normal.dot(Eigen::Vector3d(x, y, 1.0));
      if (!(slope < kFlattest)) continue;
      along_ray << point.cross(cur.normal) / slope, cur.normal / slope;
    }
    const double z = point.z() - cur.depth;
    add(by_z, -seen * by_z - since * along_ray, z,
        Weight(z * z, spread * std::hypot(ref.sigma_depth, cur.sigma_depth)));
  }
  hessian = hessian.selfadjointView<Eigen::Lower>();  // exactly symmetric
  // The motion has no prior; this only keeps the system solvable.
  hessian.diagonal().head<6>().array() += 1e-3;
  // A change of the velocity changes the motion by -H_mm^-1 H_mv.
  const MotionMatrix H_mm = hessian.topLeftCorner<6, 6>();
  const MotionMatrix H_mv = hessian.topRightCorner<6, 6>();
  const MotionMatrix follows = H_mm.ldlt().solve(H_mv);
  const MotionMatrix by_rows =
      hessian.bottomRightCorner<6, 6>() - H_mv.transpose() * follows;
  const MotionVector right_by_rows =
      right.tail<6>() - follows.transpose() * right.head<6>();
  const MotionVector prior_information =
      IndependentErrors(1.0 / prior.SigmaAngular(), 1.0 / prior.SigmaLinear())
          .diagonal();
  const Twist off = prior_mean - timing.twist;
  MotionVector prior_change;
  prior_change << off.angular, off.linear;
  // The information S of the rows is about the velocity relative to that of the
  // reference, whose covariance is P: (S^-1 + P)^-1 = (1 + S P)^-1 S.
  const Eigen::PartialPivLU<MotionMatrix> with_reference(
      MotionMatrix::Identity() + by_rows * prior.reference_covariance);
  MotionMatrix information = with_reference.solve(by_rows);
  information.diagonal() += prior_information;
  const MotionMatrix covariance = information.inverse();
  const MotionVector change =
      covariance * (with_reference.solve(right_by_rows) +
                    prior_information.cwiseProduct(prior_change));
  // An error that the reference has as well does not affect the motion.
  MotionMatrix relative_information = by_rows;
  relative_information.diagonal() += prior_information;
  MotionMatrix to_center = MotionMatrix::Identity();
  to_center.bottomRightCorner<3, 3>() =
      -cur_from_ref.rotation.conjugate().toRotationMatrix();
  const MotionMatrix moves = to_center * follows;
  return {timing.twist + Twist{change.head<3>(), change.tail<3>()}, covariance,
          -follows,
          moves * relative_information.ldlt().solve(moves.transpose())};
}

}  // namespace rgbd_pose
