#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/factors/blocks.h"
#include "core/geometry/twist.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/landmark_data.h"
#include "costs/calibration/lens.h"

// Where a view sees a landmark, and how far away: a point on the viewing ray of
// a pixel of one keyframe, its anchor, with the inverse depth d there as a
// parameter, seen by other keyframes (views). It depends on the poses of both
// (world_from_cam), on d and on a CalibrationVector theta.

namespace rgbd_pose {

// Time from colour to depth exposure of a pixel, not yet corrected, s.
template <typename T>
T DepthLag(const T* theta, double row) {
  return theta[kDepthTime] +
         row * (theta[kDepthReadout] - theta[kColorReadout]);
}

// Predicts the measured inverse depth for an inverse depth w, seen at a pixel
// when its colour row is exposed. The depth camera is displaced by omega, v
// (the registration minus the camera's motion until depth is exposed). It sees
// the plane m of the same surface, w m . X = 1, at the same pixel at
//
//   w' = w (1 + omega . (m x r) - w (m . v))
//
// to first order, and measures factor * (w' - offset).
template <typename T>
T MeasuredFrom(const T& w, const T* theta, const LandmarkData& data) {
  const MeasuredInverseDepth& at = data.depth;
  const Twist& twist = data.motion.twist;
  const Eigen::Vector3d lever = at.plane.cross(at.ray);
  const T lag = DepthLag(theta, data.motion.row);
  T turned(0.0), shifted(0.0);
  for (int i = 0; i < 3; ++i) {
    turned += lever[i] * (theta[kRotationX + i] - lag * twist.angular[i] -
                          at.undone_rotation[i]);
    shifted += at.plane[i] * (theta[kTranslationX + i] - lag * twist.linear[i] -
                              at.undone_translation[i]);
  }
  return theta[kDepthFactor] *
         (w * (1.0 + turned - w * shifted) - theta[kInverseDepth]);
}

// The same with its derivatives by w and theta.
struct MeasuredFromDerivatives {
  double value;
  double by_w;
  Eigen::Matrix<double, 1, kCalibrationSize> by_theta;

  MeasuredFromDerivatives(double w, const double* theta,
                          const LandmarkData& data) {
    const MeasuredInverseDepth& at = data.depth;
    const Eigen::Vector3d lever = at.plane.cross(at.ray);
    const Eigen::Map<const Eigen::Vector3d> rotation(theta + kRotationX);
    const Eigen::Map<const Eigen::Vector3d> translation(theta + kTranslationX);
    const Twist& twist = data.motion.twist;
    const double lag = DepthLag(theta, data.motion.row);
    const double factor = theta[kDepthFactor];
    const double turned =
        lever.dot(rotation - lag * twist.angular - at.undone_rotation);
    const double shifted =
        at.plane.dot(translation - lag * twist.linear - at.undone_translation);
    const double seen = w * (1.0 + turned - w * shifted) - theta[kInverseDepth];
    value = factor * seen;
    by_w = factor * (1.0 + turned - 2.0 * w * shifted);
    by_theta.setZero();
    by_theta[kInverseDepth] = -factor;
    by_theta[kDepthFactor] = seen;
    by_theta[kDepthTime] =
        factor * w *
        (w * at.plane.dot(twist.linear) - lever.dot(twist.angular));
    by_theta[kDepthReadout] = data.motion.row * by_theta[kDepthTime];
    by_theta[kColorReadout] = -by_theta[kDepthReadout];
    by_theta.segment<3>(kRotationX) = factor * w * lever;
    by_theta.segment<3>(kTranslationX) = -factor * w * w * at.plane;
  }
};

// A landmark in the axes of a view when its row is exposed, times d. On the ray
// r = (x, y, 1) of the anchor's pixel, whose row is exposed t_a after the
// stamp,
//
//   r' = r + t_a (omega_a x r + v_a d)
//   Y  = R_v^T (R_a r' + (p_a - p_v) d)
//   Y' = Y - t_v (omega_v x Y + v_v d)
//
// with the velocities omega, v of the camera and t = color_readout * row.
template <typename T>
Eigen::Matrix<T, 3, 1> InView(const CalibratedLens<T>& lens,
                              const PoseOf<T>& anchor, const PoseOf<T>& view,
                              const T& d, const LandmarkData& data) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const Eigen::Matrix<T, 2, 1> place =
      Undistorted(lens, data.anchor_u, data.anchor_v);
  const auto moved = [&](const RowMotion& motion, const Vector& X,
                         double sign) {
    const Vector omega = motion.twist.angular.template cast<T>();
    const Vector v = motion.twist.linear.template cast<T>();
    const Vector apart = (omega.cross(X) + v * d) * (sign * motion.row);
    return Vector(X + apart * lens.theta[kColorReadout]);
  };
  const Vector ray =
      moved(data.anchor_motion, Vector(place[0], place[1], T(1.0)), 1.0);
  const Vector in_world = anchor.q * ray + (anchor.p - view.p) * d;
  return moved(data.motion, view.q.conjugate() * in_world, -1.0);
}

// The same with its derivatives by d, by the poses in their tangents and, of
// theta, by the lens and the colour readout.
struct InViewDerivatives {
  Eigen::Vector3d Y;
  Eigen::Matrix<double, 3, 6> by_anchor, by_view;
  Eigen::Vector3d by_inverse_depth;
  Eigen::Vector3d by_color_readout;
  Eigen::Matrix<double, 3, kLensSize> by_lens;

  InViewDerivatives(const CalibratedLens<double>& lens,
                    const PoseOf<double>& anchor, const PoseOf<double>& view,
                    double d, const LandmarkData& data) {
    const double* const theta = lens.theta;
    const Eigen::Vector2d seen = lens.FromPixel(data.anchor_u, data.anchor_v);
    const Eigen::Vector2d place =
        Undistorted(lens, data.anchor_u, data.anchor_v);
    const double readout = theta[kColorReadout];
    const Moved from(data.anchor_motion, readout);
    const Moved to(data.motion, -readout);
    const Eigen::Vector3d at_row(place[0], place[1], 1.0);
    const Eigen::Vector3d ray = from.turn * at_row + from.shift * d;
    const Eigen::Vector3d baseline = anchor.p - view.p;
    const Eigen::Matrix3d view_from_world = view.R().transpose();
    const Eigen::Matrix3d view_from_anchor = view_from_world * anchor.R();
    const Eigen::Vector3d in_view =
        view_from_anchor * ray + view_from_world * baseline * d;
    const Eigen::Matrix3d from_world = to.turn * view_from_world;
    const Eigen::Matrix3d from_anchor = to.turn * view_from_anchor;
    Y = to.turn * in_view + to.shift * d;
    by_inverse_depth =
        from_world * baseline + from_anchor * from.shift + to.shift;
    by_color_readout =
        from_anchor * data.anchor_motion.row *
            (data.anchor_motion.twist.angular.cross(at_row) +
             d * data.anchor_motion.twist.linear) -
        data.motion.row * (data.motion.twist.angular.cross(in_view) +
                           d * data.motion.twist.linear);
    by_anchor << -from_anchor * CrossMatrix(ray), d * from_world;
    by_view << to.turn * CrossMatrix(in_view), -d * from_world;
    // The ray by the lens: Distort(ray; k) = seen(f, c).
    Eigen::Matrix<double, 2, kLensSize> moved;
    moved.leftCols<4>() << -seen[0] / theta[kFx], 0.0, -1.0 / theta[kFx], 0.0,
        0.0, -seen[1] / theta[kFy], 0.0, -1.0 / theta[kFy];
    moved.rightCols<kDistortionSize>() =
        -DistortByCoefficients(lens, place[0], place[1]);
    by_lens = (from_anchor * from.turn).leftCols<2>() *
              (DistortDerivative(lens, place[0], place[1]).inverse() * moved);
  }

 private:
  // X + readout row (omega x X + v d) = turn X + shift d.
  struct Moved {
    Eigen::Matrix3d turn;
    Eigen::Vector3d shift;

    Moved(const RowMotion& motion, double readout)
        : shift(readout * motion.row * motion.twist.linear) {
      const Eigen::Vector3d w = readout * motion.row * motion.twist.angular;
      turn = Eigen::Matrix3d::Identity() + CrossMatrix(w);
    }
  };
};

}  // namespace rgbd_pose
