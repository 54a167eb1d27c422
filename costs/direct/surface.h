#pragma once

#include "core/estimation/frame_view.h"
#include "core/util/lane_math.h"
#include "costs/direct/direct_points.h"
#include "costs/direct/lane_image.h"

namespace rgbd_pose {

// Distance between the depths of a surface, px. Adjacent depths share their
// noise, and slopes from them are too noisy.
constexpr int kSurfaceStep = 4;

// A point of the previous frame's surface as seen in the current frame, and the
// plane N . p = 1 (p in current axes, m; N in 1 / m) of the surface measured
// there: its slope is that of the previous surface, moved, its distance the
// mean of nine measured inverse depths. In normalised image coordinates the
// inverse depth of a plane is linear: 1 / z = N . (x, y, 1).
template <typename D>
struct MeasuredSurface {
  D q[3];       // m
  D plane[3];   // N, 1 / m
  D excess;     // N . q - 1: 0 on the surface, about (q_z - z) / z
  D rejection;  // 1 or more: an edge, not a surface
};

// Noise of a surface's slope per pixel, in residual sigmas, for a plane through
// 5 x 5 depths, 3 px apart.
constexpr double kSlopeNoise = 0.0667;

// Sigma of a surface point relative to the sigma of one depth, from simulated
// pairs: averages of nine and of 25 depths with correlated noise.
constexpr double kSurfaceSigma = 0.707;

// Common part of the costs on surfaces. Columns of a point (see SmoothPoints):
// X_prev (m), the plane N . X_prev = 1 (1 / m), the sigma of its depth (m).
struct Surface : DirectResidual {
  static constexpr int kScaleGroup = 2;  // depths
  static constexpr int kPointColumns = 7;

  // Noise of neighbouring depths is correlated (docs/direct.md).
  static constexpr double kInformation = 0.75;

  static constexpr auto* Points = &SmoothPoints;

  template <typename D>
  [[gnu::always_inline]] static void Locate(const DirectInput& input,
                                            const D* point,
                                            ProjectedPoint<D>* place) {
    D q[3], in_row[3];
    Move(input, point, q, in_row);
    const D inverse = 1.0 / in_row[2];
    ProjectedPixel<D> pixel;
    ProjectWithJacobian(input.cur->levels[0].camera, input.lens,
                        D(in_row[0] * inverse), D(in_row[1] * inverse), &pixel);
    *place = {pixel.u, pixel.v, in_row[2]};
  }

  // A point in current axes, m: at the stamp (q), and when its row of the depth
  // image is exposed (in_row).
  template <typename D>
  [[gnu::always_inline]] static void Move(const DirectInput& input,
                                          const D* point, D* q, D* in_row) {
    Multiply(input.R, point, q);
    for (int i = 0; i < 3; ++i) in_row[i] = q[i] += input.t[i];
    if (!input.moves_depth) return;
    const FrameTiming& timing = input.cur->timing;
    MoveToRow(input.cur->levels[0].camera, input.lens, timing.depth,
              timing.twist, q, in_row);
  }

  // The offset of the point from the nearest whole pixel (px, to the right and
  // down), and 3 x 3 raw depths around that pixel.
  static constexpr int kSamples = 11;
  [[gnu::always_inline]] static bool Read(const DirectInput& input, double u,
                                          double v, ptrdiff_t stride,
                                          float* samples) {
    constexpr double kBorder = kSurfaceStep + 1.0;
    const ImageView<uint16_t>& depth = input.cur->depth;
    if (!(u >= kBorder && v >= kBorder && u < depth.width - 1.0 - kBorder &&
          v < depth.height - 1.0 - kBorder)) {
      return false;
    }
    const int column = static_cast<int>(u + 0.5);
    const int row = static_cast<int>(v + 0.5);
    const uint16_t* at = depth.data + row * depth.stride + column;
    samples[0] = static_cast<float>(u - column);
    samples[stride] = static_cast<float>(v - row);
    // The raw values 0 and 65535 mean no depth; adding 1 makes them 1 and 0.
    bool is_measured = true;
    for (int k = 0; k < 9; ++k) {
      const uint16_t raw = at[(k / 3 - 1) * kSurfaceStep * depth.stride +
                              (k % 3 - 1) * kSurfaceStep];
      is_measured &= static_cast<uint16_t>(raw + 1) > 1;
      samples[(2 + k) * stride] = raw;
    }
    return is_measured;
  }

  template <typename D>
  [[gnu::always_inline]] static void Measure(const DirectInput& input,
                                             const D* point, const D* samples,
                                             MeasuredSurface<D>* s) {
    // The 99 % quantile of chi^2 with eight degrees of freedom.
    constexpr double kMaxSquares = 20.1;
    const Camera& camera = input.cur->levels[0].camera;
    const double per_u = 1.0 / camera.fx, per_v = 1.0 / camera.fy;
    D in_row[3];
    Move(input, point, s->q, in_row);
    // The surface's offset from the point is taken to be equal at the stamp.
    const D inverse_z = 1.0 / s->q[2], inverse_measured_z = 1.0 / in_row[2];
    // The moved plane is n . p = 1 + n . t; near q only its slope matters.
    D n[3];
    Multiply(input.R, point + 3, n);
    const D scale = 1.0 / (n[0] * s->q[0] + n[1] * s->q[1] + n[2] * s->q[2]);
    for (int i = 0; i < 3; ++i) n[i] *= scale;
    D sum = {}, squares = {};
    for (int k = 0; k < 9; ++k) {
      const int i = (k % 3 - 1) * kSurfaceStep, j = (k / 3 - 1) * kSurfaceStep;
      const D off = input.cur->depth_scale / samples[2 + k] -
                    inverse_measured_z -
                    (n[0] * (i * per_u) + n[1] * (j * per_v));
      sum += off;
      squares += off * off;
    }
    const D mean = sum * (1.0 / 9.0);
    // From the nearest pixel to the point's position. Over half a pixel,
    // distortion does not matter.
    const D measured = inverse_z + mean + n[0] * (samples[0] * per_u) +
                       n[1] * (samples[1] * per_v);
    s->plane[0] = n[0];
    s->plane[1] = n[1];
    s->plane[2] =
        measured - n[0] * (s->q[0] * inverse_z) - n[1] * (s->q[1] * inverse_z);
    s->excess = measured * s->q[2] - 1.0;
    const D sigma = point[6] / (point[2] * point[2]);
    s->rejection =
        (squares - 9.0 * mean * mean) / (kMaxSquares * sigma * sigma);
  }
};

}  // namespace rgbd_pose
