#pragma once

#include "costs/direct/surface.h"
#include "costs/parts/moved_point.h"

namespace rgbd_pose {

// The difference in inverse depth between the surface measured in the current
// frame, the plane N . p = 1 (surface.h), and a point of the previous frame:
//
//   r = (1 / Z_cur - 1 / q_z) / sigma = (N . q - 1) / (sigma q_z)
//
// with q = R (X_prev - C), the point moved into the current frame. The noise of
// a structured-light camera is constant in inverse depth.
struct InverseDepth : Surface {
  static constexpr char kName[] = "inverse_depth";
  static constexpr int kColumns = 7;  // X_prev, N / sigma, 1 / sigma

  template <typename D>
  [[gnu::always_inline]] static void LookUp(const DirectInput& input,
                                            const D* point, const D* samples,
                                            D* columns, D* rejection) {
    // Above this, another surface hides the point or lies behind it.
    constexpr double kMaxRelativeStep = 0.1;
    MeasuredSurface<D> surface;
    Measure(input, point, samples, &surface);
    const D w = point[2] * point[2] / (kSurfaceSigma * point[6]);
    for (int i = 0; i < 3; ++i) {
      columns[i] = point[i];
      columns[3 + i] = w * surface.plane[i];
    }
    columns[6] = w;
    const D step = surface.excess * (1.0 / kMaxRelativeStep);
    *rejection = surface.rejection + step * step;
  }

  static void NoiseRow(const DirectInput& input, int axis, double* columns) {
    const Camera& camera = input.cur->levels[0].camera;
    columns[3] = axis == 0 ? kSlopeNoise * camera.fx : 0.0;
    columns[4] = axis == 1 ? kSlopeNoise * camera.fy : 0.0;
    columns[5] = columns[6] = 0.0;  // neither adds noise to the derivative
  }

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    T q[3];
    Forward::TransformPoint(motion, columns, q);
    r[0] = (columns[3] * q[0] + columns[4] * q[1] + columns[5] * q[2] -
            columns[6]) /
           q[2];
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    D q[3];
    Forward::TransformPoint(motion, columns, q);
    const D inverse = 1.0 / q[2];
    const D a = columns[3] * inverse;
    const D b = columns[4] * inverse;
    const D flow = a * q[0] + b * q[1] - columns[6] * inverse;
    r[0] = columns[5] + flow;
    RowOfPoint(motion, columns, {a, b, -flow * inverse}, J[0]);
  }
};

}  // namespace rgbd_pose
