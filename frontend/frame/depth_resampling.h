#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>

#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Interpolation of raw depths between pixels: for one, eight and all pixels.

// Neighbours that differ by more than this fraction of the nearest depth are on
// different surfaces. 1.6 % is 4 sigmas of a Kinect at 3 m, and the step
// between neighbouring pixels on a surface seen at 83 degrees.
constexpr int kMaxStepShift = 6;  // 2^-6

// Raw depth of an image (CV_16UC1, 0: none) between pixels of one surface,
// otherwise of the nearest pixel; 0 outside.
inline float SampleDepth(const cv::Mat& depth, float u, float v) {
  const int left = cvFloor(u);
  const int above = cvFloor(v);
  const float right = u - static_cast<float>(left);
  const float down = v - static_cast<float>(above);
  const int column = left + (right >= 0.5F);
  const int row = above + (down >= 0.5F);
  if (column < 0 || row < 0 || column >= depth.cols || row >= depth.rows) {
    return 0.0F;
  }
  const uint16_t nearest = depth.at<uint16_t>(row, column);
  if (nearest == 0 || left < 0 || above < 0 || left + 1 >= depth.cols ||
      above + 1 >= depth.rows) {
    return nearest;
  }
  const auto* a = depth.ptr<uint16_t>(above) + left;
  const auto* b = depth.ptr<uint16_t>(above + 1) + left;
  const uint16_t low = std::min(std::min(a[0], a[1]), std::min(b[0], b[1]));
  const uint16_t high = std::max(std::max(a[0], a[1]), std::max(b[0], b[1]));
  if (high - low > (low >> kMaxStepShift)) return nearest;
  const float top = a[0] + right * static_cast<float>(a[1] - a[0]);
  const float bottom = b[0] + right * static_cast<float>(b[1] - b[0]);
  return top + down * (bottom - top);
}

// The common motion of eight neighbours: the position between pixels where they
// are sampled, and the scale and offset to apply to their raw depths.
struct EightMoves {
  float right, down, scale, offset;
};

// SampleDepth and EncodeDepth for eight pixels at once. `top` and
// `bottom` are the two rows around the samples, `nearest` the nearest pixels.
inline void MoveEight(const uint16_t* top, const uint16_t* bottom,
                      const uint16_t* nearest, const EightMoves& by,
                      uint16_t* to) {
  const cv::v_uint16x8 a = cv::v_load(top);
  const cv::v_uint16x8 b = cv::v_load(top + 1);
  const cv::v_uint16x8 c = cv::v_load(bottom);
  const cv::v_uint16x8 d = cv::v_load(bottom + 1);
  const cv::v_uint16x8 near = cv::v_load(nearest);
  const cv::v_uint16x8 low = cv::v_min(cv::v_min(a, b), cv::v_min(c, d));
  const cv::v_uint16x8 high = cv::v_max(cv::v_max(a, b), cv::v_max(c, d));
  const cv::v_uint16x8 is_one = (high - low) <= (low >> kMaxStepShift);

  const cv::v_float32x4 right = cv::v_setall_f32(by.right);
  const cv::v_float32x4 down = cv::v_setall_f32(by.down);
  const cv::v_float32x4 scale = cv::v_setall_f32(by.scale);
  const cv::v_float32x4 offset = cv::v_setall_f32(by.offset);
  const auto halves = [](const cv::v_uint16x8& raw) {
    std::array<cv::v_uint32x4, 2> whole;
    cv::v_expand(raw, whole[0], whole[1]);
    return std::array<cv::v_float32x4, 2>{
        cv::v_cvt_f32(cv::v_reinterpret_as_s32(whole[0])),
        cv::v_cvt_f32(cv::v_reinterpret_as_s32(whole[1]))};
  };
  const auto encode = [&](const std::array<cv::v_float32x4, 2>& raw) {
    return cv::v_pack_u(cv::v_round(cv::v_muladd(raw[0], scale, offset)),
                        cv::v_round(cv::v_muladd(raw[1], scale, offset)));
  };
  const auto fa = halves(a), fb = halves(b), fc = halves(c), fd = halves(d);
  std::array<cv::v_float32x4, 2> between;
  for (int i = 0; i < 2; ++i) {
    const cv::v_float32x4 above = cv::v_muladd(fb[i] - fa[i], right, fa[i]);
    const cv::v_float32x4 below = cv::v_muladd(fd[i] - fc[i], right, fc[i]);
    between[i] = cv::v_muladd(below - above, down, above);
  }
  const cv::v_uint16x8 moved =
      cv::v_select(is_one, encode(between), encode(halves(near)));
  const cv::v_uint16x8 none = (near == cv::v_setzero_u16()) |
                              (moved == cv::v_setall_u16(Frame::kNoDepth));
  cv::v_store(to, moved & ~none);
}

// Rounds a depth in raw units; a depth that does not fit becomes 0 (unknown).
inline uint16_t EncodeDepth(float raw) {
  return raw > 0.0F && raw < static_cast<float>(Frame::kNoDepth) - 0.5F
             ? static_cast<uint16_t>(raw + 0.5F)
             : 0;
}

// Resamples a depth image (CV_16UC1, 0: no depth) by SampleDepth, so edges are
// not smeared. `place` maps the centre of a pixel of the result to its position
// in `depth`, px.
inline cv::Mat ResampleDepth(const cv::Mat& depth, const cv::Size& size,
                             const cv::Matx23d& place) {
  const cv::Matx23f to_depth = place;
  cv::Mat resampled = cv::Mat::zeros(size, CV_16UC1);
  for (int v = 0; v < size.height; ++v) {
    auto* to = resampled.ptr<uint16_t>(v);
    for (int u = 0; u < size.width; ++u) {
      const cv::Vec2f at = to_depth * cv::Vec3f(u, v, 1.0F);
      if (at[0] > -1.0F && at[0] < depth.cols && at[1] > -1.0F &&
          at[1] < depth.rows) {
        to[u] = EncodeDepth(SampleDepth(depth, at[0], at[1]));
      }
    }
  }
  return resampled;
}

}  // namespace rgbd_pose
