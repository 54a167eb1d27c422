#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"

namespace rgbd_pose {

// The lens of a camera whose fx, fy, cx, cy, k1 and k2 are those of a
// CalibrationVector, for any scalar (double or ceres::Jet); the rest of the
// distortion is that of `rest`.
template <typename T>
struct Lens {
  using Pair = Eigen::Matrix<T, 2, 1>;

  const T* theta;
  const Camera& rest;

  // Where a point (x, y, 1) is seen, on the plane z = 1.
  Pair Distort(const T& x, const T& y) const {
    const T r2 = x * x + y * y;
    const T radial = 1.0 + r2 * (theta[kK1] + r2 * (theta[kK2] + r2 * rest.k3));
    return {x * radial + 2.0 * rest.p1 * x * y + rest.p2 * (r2 + 2.0 * x * x),
            y * radial + rest.p1 * (r2 + 2.0 * y * y) + 2.0 * rest.p2 * x * y};
  }

  // The pixel of it.
  Pair ToPixel(const Pair& distorted) const {
    return {theta[kFx] * distorted[0] + theta[kCx],
            theta[kFy] * distorted[1] + theta[kCy]};
  }

  // The place on the plane z = 1 that a pixel is of, distorted.
  Pair FromPixel(double u, double v) const {
    return {(u - theta[kCx]) / theta[kFx], (v - theta[kCy]) / theta[kFy]};
  }
};

// d Distort / d (x, y).
inline Eigen::Matrix2d DistortDerivative(const Lens<double>& lens, double x,
                                         double y) {
  const double k1 = lens.theta[kK1], k2 = lens.theta[kK2], k3 = lens.rest.k3;
  const double p1 = lens.rest.p1, p2 = lens.rest.p2;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));
  Eigen::Matrix2d D;
  D << radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x,
      slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y,  //
      slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y,
      radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  return D;
}

// The place (x, y, 1) that is seen at a pixel, by Newton's method.
inline Eigen::Vector2d Undistorted(const Lens<double>& lens, double u,
                                   double v) {
  constexpr int kMaxSteps = 10;
  constexpr double kTolerance = 1e-13;
  const Eigen::Vector2d seen = lens.FromPixel(u, v);
  Eigen::Vector2d place = seen;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Vector2d change =
        DistortDerivative(lens, place[0], place[1]).inverse() *
        (seen - lens.Distort(place[0], place[1]));
    place += change;
    if (!(change.lpNorm<Eigen::Infinity>() > kTolerance)) break;
  }
  return place;
}

// The same with derivatives: one more step from where the values lead has them
// exactly.
template <typename T>
Eigen::Matrix<T, 2, 1> Undistorted(const Lens<T>& lens, double u, double v) {
  double values[kCalibrationSize];
  for (int k = 0; k < kCalibrationSize; ++k) values[k] = lens.theta[k].a;
  const Lens<double> plain{values, lens.rest};
  const Eigen::Vector2d place = Undistorted(plain, u, v);
  const Eigen::Matrix2d inverse =
      DistortDerivative(plain, place[0], place[1]).inverse();
  const Eigen::Matrix<T, 2, 1> off =
      lens.FromPixel(u, v) - lens.Distort(T(place[0]), T(place[1]));
  Eigen::Matrix<T, 2, 1> result;
  for (int i = 0; i < 2; ++i) {
    result[i] = place[i] + inverse(i, 0) * off[0] + inverse(i, 1) * off[1];
  }
  return result;
}

}  // namespace rgbd_pose
