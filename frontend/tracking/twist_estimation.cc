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

// What rows tell of a change of the velocity, whatever the motion is.
struct RowInformation {
  // A change of the velocity changes the motion by -follows.
  MotionMatrix follows;

  // The normal equations of the change.
  MotionMatrix information;
  MotionVector right;
};

// Normal equations of the change of the motion (rotation, then translation, in
// current axes) and the change of the velocity (angular, then linear).
class TwistEquations {
 public:
  TwistEquations(const Camera& camera, const FrameTiming& timing, double spread)
      : camera_(camera), timing_(timing), spread_(spread) {}

  // Adds a match whose point is expected here in current axes.
  void Add(const Match& match, const Eigen::Vector3d& point) {
    const auto& [ref, cur] = match;
    const double inverse = 1.0 / point.z();
    const double x = point.x() * inverse, y = point.y() * inverse;
    // Derivatives of x, y and z by the motion.
    MotionVector by_x, by_y, by_z;
    by_x << -x * y, 1.0 + x * x, -y, inverse, 0.0, -x * inverse;
    by_y << -1.0 - y * y, x * y, x, 0.0, inverse, -y * inverse;
    by_z << point.y(), -point.x(), 0.0, 0.0, 0.0, 1.0;
    // The row in which the point was seen, up to some pixels.
    const double row = cur.v;
    const double u = camera_.fx * x + camera_.cx - cur.u;
    const double v = camera_.fy * y + camera_.cy - cur.v;
    const double weight =
        Weight(u * u + v * v, spread_ * std::hypot(ref.sigma_px, cur.sigma_px));
    // For a point seen `seen` seconds after the stamp, a change of the velocity
    // acts like a motion in the opposite direction for this time.
    const double seen = timing_.color.RowTime(row, camera_.height);
    AddResidual(camera_.fx * by_x, -seen * camera_.fx * by_x, u, weight);
    AddResidual(camera_.fy * by_y, -seen * camera_.fy * by_y, v, weight);
    if (cur.depth <= 0.0) return;
    // Between the colour and the depth exposure the surface moves along the
    // viewing ray; how far depends on its slope.
    const double since = timing_.depth.RowTime(row, camera_.height) - seen;
    MotionVector along_ray = MotionVector::Zero();
    if (since != 0.0) {
      const double slope = cur.normal.dot(Eigen::Vector3d(x, y, 1.0));
      if (!(slope < kFlattest)) return;
      along_ray << point.cross(cur.normal) / slope, cur.normal / slope;
    }
    const double z = point.z() - cur.depth;
    AddResidual(
        by_z, -seen * by_z - since * along_ray, z,
        Weight(z * z, spread_ * std::hypot(ref.sigma_depth, cur.sigma_depth)));
  }

  // Eliminates the motion.
  RowInformation WithoutMotion() const {
    // Rounding errors make the two triangles differ.
    Matrix12 hessian = hessian_.selfadjointView<Eigen::Lower>();
    // The motion has no prior; this only keeps the system solvable.
    hessian.diagonal().head<6>().array() += 1e-3;
    // A change of the velocity changes the motion by -H_mm^-1 H_mv.
    const MotionMatrix H_mm = hessian.topLeftCorner<6, 6>();
    const MotionMatrix H_mv = hessian.topRightCorner<6, 6>();
    const MotionMatrix follows = H_mm.ldlt().solve(H_mv);
    return {follows,
            hessian.bottomRightCorner<6, 6>() - H_mv.transpose() * follows,
            right_.tail<6>() - follows.transpose() * right_.head<6>()};
  }

 private:
  // Takes the derivatives of a residual by both changes.
  void AddResidual(const MotionVector& by_motion,
                   const MotionVector& by_velocity, double residual,
                   double weight) {
    Vector12 both;
    both << by_motion, by_velocity;
    hessian_.noalias() += both * (weight * both).transpose();
    right_ -= weight * residual * both;
  }

  const Camera& camera_;
  const FrameTiming& timing_;
  const double spread_;  // of residuals, in sigmas
  Matrix12 hessian_ = Matrix12::Zero();
  Vector12 right_ = Vector12::Zero();
};

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
  TwistEquations equations(matches.camera(), timing, std::max(1.0, sigma));
  for (size_t i = 0; i < matches.size(); ++i) {
    const Match& match = matches[i];
    if (!is_inlier[i] || match.prev.depth <= 0.0) continue;
    const Eigen::Vector3d point = cur_from_ref * matches.Point(match.prev);
    if (point.z() > 0.0) equations.Add(match, point);
  }
  const RowInformation rows = equations.WithoutMotion();
  const MotionVector prior_information =
      IndependentErrors(1.0 / prior.SigmaAngular(), 1.0 / prior.SigmaLinear())
          .diagonal();
  const Twist off = prior_mean - timing.twist;
  MotionVector prior_change;
  prior_change << off.angular, off.linear;
  // The information S of the rows is about the velocity relative to that of the
  // reference, whose covariance is P: (S^-1 + P)^-1 = (1 + S P)^-1 S.
  const Eigen::PartialPivLU<MotionMatrix> with_reference(
      MotionMatrix::Identity() + rows.information * prior.reference_covariance);
  MotionMatrix information = with_reference.solve(rows.information);
  information.diagonal() += prior_information;
  const MotionMatrix covariance = information.inverse();
  const MotionVector change =
      covariance * (with_reference.solve(rows.right) +
                    prior_information.cwiseProduct(prior_change));
  // An error that the reference has as well does not affect the motion.
  MotionMatrix relative_information = rows.information;
  relative_information.diagonal() += prior_information;
  MotionMatrix to_center = MotionMatrix::Identity();
  to_center.bottomRightCorner<3, 3>() =
      -cur_from_ref.rotation.conjugate().toRotationMatrix();
  const MotionMatrix moves = to_center * rows.follows;
  return {timing.twist + Twist{change.head<3>(), change.tail<3>()}, covariance,
          -rows.follows,
          moves * relative_information.ldlt().solve(moves.transpose())};
}

}  // namespace rgbd_pose
