#pragma once

#include "core/util/lane_math.h"

namespace rgbd_pose {

// Meaning of the coefficients, with the names used by ROS.
enum class LensModel {
  kRational,     // plumb_bob, and rational_polynomial, which adds k4 k5 k6
  kEquidistant,  // fisheye: k1 k2 k3 k4 (Kannala & Brandt, PAMI 2006)
};

// Distorted coordinates (x / z, y / z) and derivatives by the undistorted ones.
template <typename D>
struct DistortedPoint {
  D x, y;
  D x_x, x_y, y_y;  // dx / dx, dx / dy = dy / dx, dy / dy
};

// Distortion of normalised image coordinates,
//
//   x' = x f + 2 p1 x y + p2 (r^2 + 2 x^2)     r^2 = x^2 + y^2
//   y' = y f + p1 (r^2 + 2 y^2) + 2 p2 x y
//   rational:    f = (1 + k1 r^2 + k2 r^4 + k3 r^6) /
//                    (1 + k4 r^2 + k5 r^4 + k6 r^6)
//   equidistant: f = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8) / r, t = atan r
//
// as in OpenCV. S is the type of the coefficients: double, float or ceres::Jet.
// The coordinates may be vectors (one lane per point) or arrays of S.
template <typename S>
struct Lens {
  // Which radial factor has to be computed.
  enum class Factor { kNone, kPolynomial, kRational, kEquidistant };

  Factor factor = Factor::kNone;
  S k1 = S(0), k2 = S(0), p1 = S(0), p2 = S(0), k3 = S(0);
  S k4 = S(0), k5 = S(0), k6 = S(0);

  // f at r^2.
  template <typename D>
  [[gnu::always_inline]] inline void Radial(const D& r2, D* f) const {
    switch (factor) {
      case Factor::kEquidistant: {
        const D r = sqrt(r2 + S(kSmall));
        const D t = atan(r);
        const D t2 = t * t;
        *f = t * (S(1) + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4)))) / r;
        return;
      }
      case Factor::kRational:
        *f = (S(1) + r2 * (k1 + r2 * (k2 + r2 * k3))) /
             (S(1) + r2 * (k4 + r2 * (k5 + r2 * k6)));
        return;
      default:
        *f = S(1) + r2 * (k1 + r2 * (k2 + r2 * k3));
    }
  }

  // df / d(r^2); f is the result of Radial.
  template <typename D>
  [[gnu::always_inline]] inline void RadialSlope(const D& r2, const D& f,
                                                 D* slope) const {
    switch (factor) {
      case Factor::kEquidistant: {
        const D square = r2 + S(kSmall);
        const D t = atan(sqrt(square));
        const D t2 = t * t;
        const D by_t =
            S(1) +
            t2 * (S(3) * k1 +
                  t2 * (S(5) * k2 + t2 * (S(7) * k3 + t2 * (S(9) * k4))));
        *slope = (by_t / (S(1) + square) - f) / (S(2) * square);
        return;
      }
      case Factor::kRational:
        *slope = (k1 + r2 * (S(2) * k2 + r2 * (S(3) * k3)) -
                  f * (k4 + r2 * (S(2) * k5 + r2 * (S(3) * k6)))) /
                 (S(1) + r2 * (k4 + r2 * (k5 + r2 * k6)));
        return;
      default:
        *slope = k1 + r2 * (S(2) * k2 + r2 * (S(3) * k3));
    }
  }

  // df / dk1 .. dk4. The fourth applies to an equidistant lens only.
  template <typename D>
  [[gnu::always_inline]] inline void RadialByCoefficients(const D& r2,
                                                          D (&by)[4]) const {
    D of_k1 = r2, step = r2;
    if (factor == Factor::kEquidistant) {
      const D r = sqrt(r2 + S(kSmall));
      const D t = atan(r);
      step = t * t;
      of_k1 = step * t / r;
    } else if (factor == Factor::kRational) {
      of_k1 = r2 / (S(1) + r2 * (k4 + r2 * (k5 + r2 * k6)));
    }
    by[0] = of_k1;
    for (int k = 1; k < 4; ++k) by[k] = by[k - 1] * step;
  }

  // The distorted coordinates only.
  template <typename D>
  [[gnu::always_inline]] inline void Distort(const D& x, const D& y, D* xd,
                                             D* yd) const {
    const D r2 = x * x + y * y;
    D f;
    Radial(r2, &f);
    *xd = x * f + S(2) * p1 * x * y + p2 * (r2 + S(2) * x * x);
    *yd = y * f + p1 * (r2 + S(2) * y * y) + S(2) * p2 * x * y;
  }

  // The distorted coordinates and their derivatives.
  template <typename D>
  [[gnu::always_inline]] inline void Distort(const D& x, const D& y,
                                             DistortedPoint<D>* p) const {
    const D r2 = x * x + y * y;
    D f, slope;
    Radial(r2, &f);
    RadialSlope(r2, f, &slope);
    p->x = x * f + S(2) * p1 * x * y + p2 * (r2 + S(2) * x * x);
    p->y = y * f + p1 * (r2 + S(2) * y * y) + S(2) * p2 * x * y;
    p->x_x = f + S(2) * x * x * slope + S(2) * p1 * y + S(6) * p2 * x;
    p->x_y = S(2) * (x * y * slope + p1 * x + p2 * y);
    p->y_y = f + S(2) * y * y * slope + S(6) * p1 * y + S(2) * p2 * x;
  }

 private:
  // Added to r^2 to avoid a division by 0; too small to affect results.
  static constexpr double kSmall = 1e-12;
};

}  // namespace rgbd_pose
