#pragma once

#include "core/geometry/camera.h"
#include "core/geometry/twist.h"

// Image operations of the direct costs, for double and for vectors of doubles
// (one lane per point, core/util/vector_lanes.h).

namespace rgbd_pose {

// Where a point (current axes) is seen, px, and the derivatives of that pixel
// by the normalised image coordinates x / z and y / z; with distortion.
template <typename D>
struct ProjectedPixel {
  D u, v;
  D u_x, u_y, v_x, v_y;  // du / d(x / z), ...
};

// x and y are x / z and y / z of the point; `lens` is the lens of the camera.
template <typename D>
[[gnu::always_inline]] inline void ProjectWithJacobian(const Camera& camera,
                                                       const Lens<double>& lens,
                                                       const D& x, const D& y,
                                                       ProjectedPixel<D>* p) {
  const D zero = x - x;
  if (lens.factor == Lens<double>::Factor::kNone) {
    p->u = camera.fx * x + camera.cx;
    p->v = camera.fy * y + camera.cy;
    p->u_x = zero + camera.fx;
    p->v_y = zero + camera.fy;
    p->u_y = p->v_x = zero;
    return;
  }
  DistortedPoint<D> seen;
  lens.Distort(x, y, &seen);
  p->u = camera.fx * seen.x + camera.cx;
  p->v = camera.fy * seen.y + camera.cy;
  p->u_x = camera.fx * seen.x_x;
  p->u_y = camera.fx * seen.x_y;
  p->v_x = camera.fy * seen.x_y;
  p->v_y = camera.fy * seen.y_y;
}

// Moves a point (m, camera axes at the stamp) to where it is when its row is
// exposed. The row depends on the time and the time on the row; to first order
// a division solves this. `level_camera`: camera of the level's pixels.
template <typename D>
[[gnu::always_inline]] inline void MoveToRow(const Camera& level_camera,
                                             const Lens<double>& lens,
                                             const Shutter& shutter,
                                             const Twist& twist, const D* point,
                                             D* moved) {
  const D inverse = 1.0 / point[2];
  const D x = point[0] * inverse, y = point[1] * inverse;
  ProjectedPixel<D> pixel;
  ProjectWithJacobian(level_camera, lens, x, y, &pixel);
  // Motion in the image, rows per second.
  D velocity[3];
  twist.PointVelocity(point, velocity);
  const D flow = (pixel.v_x * (velocity[0] - x * velocity[2]) +
                  pixel.v_y * (velocity[1] - y * velocity[2])) *
                 inverse;
  const double per_row = shutter.readout / level_camera.height;
  const D at_once =
      shutter.offset - 0.5 * shutter.readout + per_row * (pixel.v + 0.5);
  const D seconds = at_once / (1.0 - per_row * flow);
  twist.MovePoint(point, seconds, moved);
}

// An image between its pixels, by bilinear interpolation: the value and its
// exact derivatives per pixel.
template <typename D>
struct ImageSample {
  D value, du, dv;
};

// (s, t): position within the pixel. gray: the gray levels of the pixel and of
// its right, lower and lower right neighbours.
template <typename D>
[[gnu::always_inline]] inline void Interpolate(const D& s, const D& t,
                                               const D* gray,
                                               ImageSample<D>* sample) {
  const D top = gray[1] - gray[0], bottom = gray[3] - gray[2];
  const D above = gray[0] + s * top, below = gray[2] + s * bottom;
  sample->value = above + t * (below - above);
  sample->du = top + t * (bottom - top);
  sample->dv = below - above;
}

}  // namespace rgbd_pose
