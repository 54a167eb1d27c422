#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/geometry/camera.h"
#include "core/geometry/motion.h"
#include "core/geometry/twist.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/landmark_data.h"
#include "costs/calibration/lens.h"

// Residuals of a landmark: a point on the viewing ray of a pixel of one
// keyframe, its anchor, with the inverse depth d there as a parameter, seen by
// other keyframes (views). They depend on the poses of both (X_cam =
// R (X_world - C)), on d and on a CalibrationVector theta, and compare what the
// model predicts with the pixels and inverse depths that the sensor measures.

namespace rgbd_pose {

// Time from colour to depth exposure of a pixel, not yet corrected, s.
template <typename T>
T DepthLag(const T* theta, double row) {
  return theta[kDepthTime] +
         row * (theta[kDepthReadout] - theta[kColorReadout]);
}

// The derivatives of a residual with kRows rows.
template <int kRows>
struct LandmarkDerivatives {
  // By the six parameters of each pose, see LinearizationPoint.
  Eigen::Matrix<double, kRows, 6, Eigen::RowMajor> anchor, view;
  Eigen::Matrix<double, kRows, 1> inverse_depth;
  Eigen::Matrix<double, kRows, kCalibrationSize, Eigen::RowMajor> theta;
};

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

// The whitened error of the depth that MeasuredFrom predicts, with derivatives:
// returns the one by w, not whitened; sets those by theta.
inline double DepthError(double w, const double* theta,
                         const LandmarkData& data, double* r,
                         LandmarkDerivatives<1>* derivatives) {
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
  r[0] = (factor * seen - at.value) * at.inverse_sigma;
  auto& J = derivatives->theta;
  J.setZero();
  J[kInverseDepth] = -factor;
  J[kDepthFactor] = seen;
  J[kDepthTime] =
      factor * w * (w * at.plane.dot(twist.linear) - lever.dot(twist.angular));
  J[kDepthReadout] = data.motion.row * J[kDepthTime];
  J[kColorReadout] = -J[kDepthReadout];
  for (int i = 0; i < 3; ++i) {
    J[kRotationX + i] = factor * w * lever[i];
    J[kTranslationX + i] = -factor * w * w * at.plane[i];
  }
  J *= at.inverse_sigma;
  return factor * (1.0 + turned - 2.0 * w * shifted);
}

// A landmark in the axes of a view when its row is exposed, times d. On the ray
// r = (x, y, 1) of the anchor's pixel, whose row is exposed t_a after the
// stamp,
//
//   r' = r + t_a (omega_a x r + v_a d)
//   Y  = R_v (R_a^T r' + (C_a - C_v) d)
//   Y' = Y - t_v (omega_v x Y + v_v d)
//
// with the velocities omega, v of the camera and t = color_readout * row.
template <typename T>
Eigen::Matrix<T, 3, 1> InView(const RotationAndCenter<T>& anchor,
                              const RotationAndCenter<T>& view, const T& d,
                              const T* theta, const LandmarkData& data) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const Eigen::Matrix<T, 2, 1> place = Undistorted(
      CalibratedLens<T>(theta, *data.rest), data.anchor_u, data.anchor_v);
  const auto moved = [&](const RowMotion& motion, const Vector& X,
                         double sign) {
    const Vector omega = motion.twist.angular.template cast<T>();
    const Vector v = motion.twist.linear.template cast<T>();
    const Vector apart = (omega.cross(X) + v * d) * (sign * motion.row);
    return Vector(X + apart * theta[kColorReadout]);
  };
  const Vector ray =
      moved(data.anchor_motion, Vector(place[0], place[1], T(1.0)), 1.0);
  const Vector in_world = anchor.R.transpose() * ray + (anchor.C - view.C) * d;
  return moved(data.motion, view.R * in_world, -1.0);
}

// The same with derivatives; by theta only for the lens and the colour readout.
struct InViewDerivatives {
  Eigen::Vector3d Y;
  Eigen::Matrix<double, 3, 6> anchor, view;
  Eigen::Vector3d inverse_depth;
  Eigen::Vector3d color_readout;
  Eigen::Matrix<double, 3, kLensSize> lens;

  InViewDerivatives(const MotionDerivatives& a, const MotionDerivatives& b,
                    double d, const double* theta, const LandmarkData& data) {
    const CalibratedLens<double> at(theta, *data.rest);
    const Eigen::Vector2d seen = at.FromPixel(data.anchor_u, data.anchor_v);
    const Eigen::Vector2d place = Undistorted(at, data.anchor_u, data.anchor_v);
    const double readout = theta[kColorReadout];
    const Moved from(data.anchor_motion, readout);
    const Moved to(data.motion, -readout);
    const Eigen::Vector3d at_row(place[0], place[1], 1.0);
    const Eigen::Vector3d ray = from.turn * at_row + from.shift * d;
    const Eigen::Vector3d baseline = a.C - b.C;
    const Eigen::Vector3d in_world = a.R.transpose() * ray + baseline * d;
    const Eigen::Vector3d in_view = b.R * in_world;
    const Eigen::Matrix3d R = to.turn * b.R;
    const Eigen::Matrix3d from_anchor = R * a.R.transpose();
    Y = to.turn * in_view + to.shift * d;
    inverse_depth = R * baseline + from_anchor * from.shift + to.shift;
    color_readout =
        from_anchor * data.anchor_motion.row *
            (data.anchor_motion.twist.angular.cross(at_row) +
             d * data.anchor_motion.twist.linear) -
        data.motion.row * (data.motion.twist.angular.cross(in_view) +
                           d * data.motion.twist.linear);
    for (int k = 0; k < 3; ++k) {
      anchor.col(k) = R * (a.dR[k].transpose() * ray);
      view.col(k) = to.turn * (b.dR[k] * in_world);
      anchor.col(3 + k) = R.col(k) * d;
      view.col(3 + k) = -R.col(k) * d;
    }
    // The ray by the lens: Distort(ray; k) = seen(f, c).
    Eigen::Matrix<double, 2, kLensSize> moved;
    moved.leftCols<4>() << -seen[0] / theta[kFx], 0.0, -1.0 / theta[kFx], 0.0,
        0.0, -seen[1] / theta[kFy], 0.0, -1.0 / theta[kFy];
    moved.rightCols<kDistortionSize>() =
        -DistortByCoefficients(at, place[0], place[1]);
    lens = (from_anchor * from.turn).leftCols<2>() *
           (DistortDerivative(at, place[0], place[1]).inverse() * moved);
  }

 private:
  // X + readout row (omega x X + v d) = turn X + shift d.
  struct Moved {
    Eigen::Matrix3d turn;
    Eigen::Vector3d shift;

    Moved(const RowMotion& motion, double readout)
        : shift(readout * motion.row * motion.twist.linear) {
      const Eigen::Vector3d w = readout * motion.row * motion.twist.angular;
      turn << 1.0, -w[2], w[1], w[2], 1.0, -w[0], -w[1], w[0], 1.0;
    }
  };
};

// The pixel (u, v) at which a view sees the landmark.
struct LandmarkPixel {
  static constexpr char kName[] = "landmark_pixel";
  static constexpr int kRows = 2;

  template <typename T>
  static void Residual(const RotationAndCenter<T>& anchor,
                       const RotationAndCenter<T>& view, const T& d,
                       const T* theta, const LandmarkData& data, T* r) {
    const CalibratedLens<T> lens(theta, *data.rest);
    const Eigen::Matrix<T, 3, 1> Y = InView(anchor, view, d, theta, data);
    const Eigen::Matrix<T, 2, 1> pixel =
        lens.ToPixel(lens.Distort(Y[0] / Y[2], Y[1] / Y[2]));
    r[0] = (pixel[0] - data.u) * data.inverse_sigma_px;
    r[1] = (pixel[1] - data.v) * data.inverse_sigma_px;
  }

  static void Jacobian(const MotionDerivatives& anchor,
                       const MotionDerivatives& view, double d,
                       const double* theta, const LandmarkData& data, double* r,
                       LandmarkDerivatives<2>* J) {
    const InViewDerivatives moved(anchor, view, d, theta, data);
    const CalibratedLens<double> lens(theta, *data.rest);
    const double z = 1.0 / moved.Y[2];
    const double x = moved.Y[0] * z, y = moved.Y[1] * z;
    const Eigen::Vector2d seen = lens.Distort(x, y);
    const Eigen::Vector2d pixel = lens.ToPixel(seen);
    const double w = data.inverse_sigma_px;
    r[0] = (pixel[0] - data.u) * w;
    r[1] = (pixel[1] - data.v) * w;
    Eigen::Matrix<double, 2, 3> project;
    project << z, 0.0, -x * z, 0.0, z, -y * z;
    const Eigen::Vector2d scale(w * theta[kFx], w * theta[kFy]);
    const Eigen::Matrix<double, 2, 3> by_point =
        scale.asDiagonal() * (DistortDerivative(lens, x, y) * project);
    J->anchor = by_point * moved.anchor;
    J->view = by_point * moved.view;
    J->inverse_depth = by_point * moved.inverse_depth;
    J->theta.setZero();
    J->theta.leftCols<kLensSize>() = by_point * moved.lens;
    J->theta.col(kColorReadout) = by_point * moved.color_readout;
    J->theta(0, kFx) += w * seen[0];
    J->theta(1, kFy) += w * seen[1];
    J->theta(0, kCx) += w;
    J->theta(1, kCy) += w;
    J->theta.middleCols<kDistortionSize>(kK1) +=
        scale.asDiagonal() * DistortByCoefficients(lens, x, y);
  }
};

// The inverse depth measured in a view at the landmark.
struct LandmarkDepth {
  static constexpr char kName[] = "landmark_depth";
  static constexpr int kRows = 1;

  template <typename T>
  static void Residual(const RotationAndCenter<T>& anchor,
                       const RotationAndCenter<T>& view, const T& d,
                       const T* theta, const LandmarkData& data, T* r) {
    const Eigen::Matrix<T, 3, 1> Y = InView(anchor, view, d, theta, data);
    r[0] = (MeasuredFrom<T>(d / Y[2], theta, data) - data.depth.value) *
           data.depth.inverse_sigma;
  }

  static void Jacobian(const MotionDerivatives& anchor,
                       const MotionDerivatives& view, double d,
                       const double* theta, const LandmarkData& data, double* r,
                       LandmarkDerivatives<1>* J) {
    const InViewDerivatives moved(anchor, view, d, theta, data);
    const double z = 1.0 / moved.Y[2];
    const double by_w = DepthError(d * z, theta, data, r, J);
    const double weight = data.depth.inverse_sigma;
    const double by_z = -by_w * d * z * z * weight;
    J->anchor = by_z * moved.anchor.row(2);
    J->view = by_z * moved.view.row(2);
    J->inverse_depth[0] = by_z * moved.inverse_depth[2] + by_w * z * weight;
    J->theta.leftCols<kLensSize>() += by_z * moved.lens.row(2);
    J->theta[kColorReadout] += by_z * moved.color_readout[2];
  }
};

// The inverse depth measured at the anchor.
struct AnchorDepth {
  static constexpr char kName[] = "anchor_depth";
  static constexpr int kRows = 1;

  template <typename T>
  static void Residual(const RotationAndCenter<T>& /*anchor*/,
                       const RotationAndCenter<T>& /*view*/, const T& d,
                       const T* theta, const LandmarkData& data, T* r) {
    r[0] = (MeasuredFrom<T>(d, theta, data) - data.depth.value) *
           data.depth.inverse_sigma;
  }

  static void Jacobian(const MotionDerivatives& /*anchor*/,
                       const MotionDerivatives& /*view*/, double d,
                       const double* theta, const LandmarkData& data, double* r,
                       LandmarkDerivatives<1>* J) {
    J->anchor.setZero();
    J->view.setZero();
    J->inverse_depth[0] =
        DepthError(d, theta, data, r, J) * data.depth.inverse_sigma;
  }
};

}  // namespace rgbd_pose
