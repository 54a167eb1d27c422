#pragma once

#include "costs/direct/surface.h"
#include "costs/parts/moved_point.h"

namespace rgbd_pose {

// The distance of a point of the previous frame, moved into the current one,
// from the plane of the surface measured there (Chen & Medioni 1992; Newcombe
// et al., ISMAR 2011), which is N . p = 1 with n = N / |N| (surface.h):
//
//   r = n . (q - p) / sigma = (N . q - 1) / (|N| sigma),   q = R (X_prev - C)
//
// sigma is the part of the depth noise along n: a depth error moves a point
// along its ray (x, y, 1), of which N . ray / |N| = 1 / (z |N|) lies along n.
struct ProjectivePlane : Surface {
  static constexpr char kName[] = "projective_plane";
  static constexpr int kColumns = 7;  // X_prev, w N, w with w = 1 / (|N| sigma)

  template <typename D>
  [[gnu::always_inline]] static void LookUp(const DirectInput& input,
                                            const D* point, const D* samples,
                                            D* columns, D* rejection) {
    constexpr double kMaxDistance = 0.2;  // m; if farther, another surface
    MeasuredSurface<D> surface;
    Measure(input, point, samples, &surface);
    const D* const N = surface.plane;
    const D length2 = N[0] * N[0] + N[1] * N[1] + N[2] * N[2];
    const D w = surface.q[2] / (kSurfaceSigma * point[6]);
    for (int i = 0; i < 3; ++i) {
      columns[i] = point[i];
      columns[3 + i] = w * N[i];
    }
    columns[6] = w;
    constexpr double kMaxDistance2 = kMaxDistance * kMaxDistance;
    *rejection = surface.rejection +
                 surface.excess * surface.excess / (kMaxDistance2 * length2);
  }

  // N becomes noise (1, 0, -x) or (0, 1, -y), where |N| is about 1 / z.
  static void NoiseRow(const DirectInput& input, int axis, double* columns) {
    const Camera& camera = input.cur->levels[0].camera;
    const double focal = axis == 0 ? camera.fx : camera.fy;
    const double noise = kSlopeNoise * focal / columns[2];
    columns[3] = axis == 0 ? noise : 0.0;
    columns[4] = axis == 1 ? noise : 0.0;
    columns[5] = -noise * columns[axis] / columns[2];
    columns[6] = 0.0;
  }

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    T q[3];
    Forward::TransformPoint(motion, columns, q);
    r[0] =
        columns[3] * q[0] + columns[4] * q[1] + columns[5] * q[2] - columns[6];
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    Residual(motion, columns, r);
    RowOfPoint(motion, columns, {columns[3], columns[4], columns[5]}, J[0]);
  }
};

}  // namespace rgbd_pose
