#include "frontend/frame/depth_resampling.h"

#include "core/util/floor.h"
#include "frontend/frame/depth_lanes.h"

namespace rgbd_pose {

cv::Mat ResampleDepth(const cv::Mat& depth, const cv::Size& size,
                      const cv::Matx23d& place) {
  cv::Mat padded;  // the outer half of a border pixel has its depth
  cv::copyMakeBorder(depth, padded, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  const cv::Matx23f to_padded = place + cv::Matx23d(0, 0, 1, 0, 0, 1);
  cv::Mat resampled = cv::Mat::zeros(size, CV_16UC1);
  for (int v = 0; v < size.height; ++v) {
    auto* to = resampled.ptr<uint16_t>(v);
    for (int u = 0; u < size.width; ++u) {
      const cv::Vec2f at = to_padded * cv::Vec3f(u, v, 1.0F);
      const int left = FloorToInt(at[0]);
      const int top = FloorToInt(at[1]);
      if (left < 0 || left > depth.cols || top < 0 || top > depth.rows) {
        continue;
      }
      const float right = at[0] - static_cast<float>(left);
      const float down = at[1] - static_cast<float>(top);
      const auto* above = padded.ptr<uint16_t>(top) + left;
      const auto* below = padded.ptr<uint16_t>(top + 1) + left;
      to[u] = IsOneSurface(above[0], above[1], below[0], below[1])
                  ? EncodeDepth(Between(above[0], above[1], below[0], below[1],
                                        right, down))
                  : (down < 0.5F ? above : below)[right < 0.5F ? 0 : 1];
    }
  }
  return resampled;
}

}  // namespace rgbd_pose
