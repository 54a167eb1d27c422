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
struct CalibratedLens {
  using Pair = Eigen::Matrix<T, 2, 1>;

  const T* theta;
  const Camera& rest;
  Lens<T> lens;

  CalibratedLens(const T* parameters, const Camera& camera)
      : theta(parameters), rest(camera), lens(camera.MakeLens<T>()) {
    lens.k1 = theta[kK1];
    lens.k2 = theta[kK2];
    if (lens.factor == Lens<T>::Factor::kNone) {
      lens.factor = Lens<T>::Factor::kPolynomial;
    }
  }

  // Where a point (x, y, 1) is seen, on the plane z = 1.
  Pair Distort(const T& x, const T& y) const {
    Pair distorted;
    lens.Distort(x, y, &distorted[0], &distorted[1]);
    return distorted;
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
inline Eigen::Matrix2d DistortDerivative(const CalibratedLens<double>& at,
                                         double x, double y) {
  DistortedPoint<double> p;
  at.lens.Distort(x, y, &p);
  Eigen::Matrix2d D;
  D << p.x_x, p.x_y, p.x_y, p.y_y;
  return D;
}

// d Distort / d (k1, k2).
inline Eigen::Matrix2d DistortByCoefficients(const CalibratedLens<double>& at,
                                             double x, double y) {
  double by_k1, by_k2;
  at.lens.RadialByCoefficients(x * x + y * y, &by_k1, &by_k2);
  Eigen::Matrix2d D;
  D << x * by_k1, x * by_k2, y * by_k1, y * by_k2;
  return D;
}

// The place (x, y, 1) that is seen at a pixel, by Newton's method.
inline Eigen::Vector2d Undistorted(const CalibratedLens<double>& lens, double u,
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
Eigen::Matrix<T, 2, 1> Undistorted(const CalibratedLens<T>& lens, double u,
                                   double v) {
  double values[kCalibrationSize];
  for (int k = 0; k < kCalibrationSize; ++k) values[k] = lens.theta[k].a;
  const CalibratedLens<double> plain{values, lens.rest};
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
