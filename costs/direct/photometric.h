#pragma once

#include "core/util/lane_math.h"
#include "costs/direct/direct_points.h"
#include "costs/direct/lane_image.h"
#include "costs/parts/moved_point.h"

namespace rgbd_pose {

// The difference in gray level between a point of the previous frame and the
// pixel where it is seen in the current image (Kerl, Sturm & Cremers, ICRA
// 2013; Engel, Koltun & Cremers, PAMI 2018; docs/costs.md):
//
//   r = (I_cur(u(q)) - gain I_prev - bias) / sigma,   q = R (X_prev - C)
//     = k_0 + (k_x q_x + k_y q_y) / q_z
//
// where the image is a plane around u (see DirectInput). sigma is the noise of
// both images and of u, due to the depth error. With a rolling shutter
// (FrameView::timing), u is where q is seen when its row is exposed; its
// derivative neglects that motion (3 % at 1 rad/s).
struct Photometric : DirectResidual {
  static constexpr char kName[] = "photometric";
  static constexpr int kScaleGroup = 1;  // gray levels
  static constexpr bool kSeesBrightness = true;
  static constexpr int kColumns = 6;  // X_prev, k_0, k_x, k_y

  // Noise of a gray level, including interpolation errors.
  static constexpr double kSigmaGray = 2.0;

  static constexpr int kMaxPoints = 4000;

  // Errors of neighbouring pixels are correlated (docs/direct.md).
  static constexpr double kInformation = 0.17;

  // X_prev (m), sigma of its depth (m), its gray level.
  static constexpr int kPointColumns = 5;

  static constexpr auto* Points = &TexturedPoints;

  template <typename D>
  [[gnu::always_inline]] static void Locate(const DirectInput& input,
                                            const D* point,
                                            ProjectedPoint<D>* place) {
    Seen<D> seen;
    See(input, point, &seen);
    *place = {seen.pixel.u, seen.pixel.v, seen.z};
  }

  // The position within the pixel (0 to 1, to the right and down) and the four
  // gray levels around it.
  static constexpr int kSamples = 6;
  [[gnu::always_inline]] static bool Read(const DirectInput& input, double u,
                                          double v, ptrdiff_t stride,
                                          float* samples) {
    const ImageView<uint8_t>& gray = input.cur->levels[input.level].gray;
    if (!(u >= 1.0 && v >= 1.0 && u < gray.width - 2.0 &&
          v < gray.height - 2.0)) {
      return false;
    }
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const uint8_t* const at = gray.data + row * gray.stride + column;
    samples[0 * stride] = static_cast<float>(u - column);
    samples[1 * stride] = static_cast<float>(v - row);
    samples[2 * stride] = at[0];
    samples[3 * stride] = at[1];
    samples[4 * stride] = at[gray.stride];
    samples[5 * stride] = at[gray.stride + 1];
    return true;
  }

  template <typename D>
  [[gnu::always_inline]] static void LookUp(const DirectInput& input,
                                            const D* point, const D* samples,
                                            D* columns, D* rejection) {
    Seen<D> seen;
    See(input, point, &seen);
    ImageSample<D> gray;
    Interpolate(samples[0], samples[1], samples + 2, &gray);
    const D slope_x = seen.pixel.u_x * gray.du + seen.pixel.v_x * gray.dv;
    const D slope_y = seen.pixel.u_y * gray.du + seen.pixel.v_y * gray.dv;
    // Along the ray of the previous frame: dq / d depth = R X / z.
    const D by_depth = (slope_x * (seen.turned[0] - seen.x * seen.turned[2]) +
                        slope_y * (seen.turned[1] - seen.y * seen.turned[2])) /
                       (seen.z * point[2]);
    const D depth_part = by_depth * point[3];
    const D variance =
        kSigmaGray * kSigmaGray * (1.0 + input.gain * input.gain) +
        depth_part * depth_part;
    const D w = 1.0 / sqrt(variance);
    const D r = gray.value - input.gain * point[4] - input.bias;
    for (int i = 0; i < 3; ++i) columns[i] = point[i];
    columns[3] = w * (r - slope_x * seen.x - slope_y * seen.y);
    columns[4] = w * slope_x;
    columns[5] = w * slope_y;
    *rejection = D{};
  }

  // In residual sigmas per pixel.
  static void NoiseRow(const DirectInput& input, int axis, double* columns) {
    // Noise of differences between neighbours in the smooth pyramid, relative
    // to differences between two images.
    constexpr double kSlopeNoise = 0.55;
    const Camera& camera = input.cur->levels[input.level].camera;
    columns[3] = 0.0;
    columns[4] = axis == 0 ? kSlopeNoise * camera.fx : 0.0;
    columns[5] = axis == 1 ? kSlopeNoise * camera.fy : 0.0;
  }

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    T q[3];
    Forward::TransformPoint(motion, columns, q);
    r[0] = columns[3] + (columns[4] * q[0] + columns[5] * q[1]) / q[2];
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    D q[3];
    Forward::TransformPoint(motion, columns, q);
    const D inverse = 1.0 / q[2];
    const D a = columns[4] * inverse;
    const D b = columns[5] * inverse;
    const D flow = a * q[0] + b * q[1];
    r[0] = columns[3] + flow;
    RowOfPoint(motion, columns, {a, b, -flow * inverse}, J[0]);
  }

  // Where a point is seen.
  template <typename D>
  struct Seen {
    D turned[3];  // R X, m
    D x, y, z;    // normalised image coordinates; depth, m; at the stamp
    ProjectedPixel<D> pixel;  // when its row is exposed
  };

  template <typename D>
  [[gnu::always_inline]] static void See(const DirectInput& input,
                                         const D* point, Seen<D>* seen) {
    Multiply(input.R, point, seen->turned);
    seen->z = seen->turned[2] + input.t[2];
    const D inverse = 1.0 / seen->z;
    seen->x = (seen->turned[0] + input.t[0]) * inverse;
    seen->y = (seen->turned[1] + input.t[1]) * inverse;
    const Camera& camera = input.cur->levels[input.level].camera;
    if (!input.moves_color) {
      ProjectWithJacobian(camera, input.lens, seen->x, seen->y, &seen->pixel);
      return;
    }
    const FrameTiming& timing = input.cur->timing;
    const D q[3] = {seen->x * seen->z, seen->y * seen->z, seen->z};
    D moved[3];
    MoveToRow(camera, input.lens, timing.color, timing.twist, q, moved);
    const D inverse_moved = 1.0 / moved[2];
    ProjectWithJacobian(camera, input.lens, D(moved[0] * inverse_moved),
                        D(moved[1] * inverse_moved), &seen->pixel);
  }
};

}  // namespace rgbd_pose
