#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"

namespace rgbd_pose {

// The lens of a camera with the parameters of a CalibrationVector, for any
// scalar (double or ceres::Jet). `rest` gives its model and the parameters that
// the vector lacks (k4 k5 k6 of a rational lens).
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
    lens.k3 = theta[kK3];
    if (lens.factor == Lens<T>::Factor::kEquidistant) {
      lens.k4 = theta[kK4];
      return;
    }
    lens.p1 = theta[kP1];
    lens.p2 = theta[kP2];
    if (lens.factor == Lens<T>::Factor::kNone) {
      lens.factor = Lens<T>::Factor::kPolynomial;
    }
  }

  // The distorted position of a point (x, y, 1), on the plane z = 1.
  Pair Distort(const T& x, const T& y) const {
    Pair distorted;
    lens.Distort(x, y, &distorted[0], &distorted[1]);
    return distorted;
  }

  Pair ToPixel(const Pair& distorted) const {
    return {theta[kFx] * distorted[0] + theta[kCx],
            theta[kFy] * distorted[1] + theta[kCy]};
  }

  // The distorted position of a pixel, on the plane z = 1.
  Pair FromPixel(double u, double v) const {
    return {(u - theta[kCx]) / theta[kFx], (v - theta[kCy]) / theta[kFy]};
  }
};

inline Eigen::Matrix2d DistortDerivative(const CalibratedLens<double>& at,
                                         double x, double y) {
  DistortedPoint<double> p;
  at.lens.Distort(x, y, &p);
  Eigen::Matrix2d D;
  D << p.x_x, p.x_y, p.x_y, p.y_y;
  return D;
}

// d Distort / d (k1, k2, k3, k4, p1, p2).
inline Eigen::Matrix<double, 2, kDistortionSize> DistortByCoefficients(
    const CalibratedLens<double>& at, double x, double y) {
  const double r2 = x * x + y * y;
  double by[4];
  at.lens.RadialByCoefficients(r2, by);
  Eigen::Matrix<double, 2, kDistortionSize> D;
  for (int k = 0; k < 4; ++k) D.col(k) << x * by[k], y * by[k];
  D.rightCols<2>() << 2.0 * x * y, r2 + 2.0 * x * x, r2 + 2.0 * y * y,
      2.0 * x * y;
  if (at.lens.factor == Lens<double>::Factor::kEquidistant) {
    D.rightCols<2>().setZero();
  } else {
    D.col(3).setZero();
  }
  return D;
}

// The point (x, y, 1) that is seen at a pixel, by Newton's method.
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

// The same for a ceres::Jet: one more step of Newton's method from the place
// found has the exact derivatives.
template <typename Jet>
Eigen::Matrix<Jet, 2, 1> Undistorted(const CalibratedLens<Jet>& lens, double u,
                                     double v) {
  CalibrationVector values;
  for (int k = 0; k < kCalibrationSize; ++k) values[k] = lens.theta[k].a;
  const CalibratedLens<double> plain(values.data(), lens.rest);
  const Eigen::Vector2d place = Undistorted(plain, u, v);
  const Eigen::Matrix<Jet, 2, 1> off =
      lens.FromPixel(u, v) - lens.Distort(Jet(place[0]), Jet(place[1]));
  const Eigen::Matrix2d step =
      DistortDerivative(plain, place[0], place[1]).inverse();
  return place.cast<Jet>() + step.cast<Jet>() * off;
}

}  // namespace rgbd_pose
