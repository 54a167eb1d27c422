#include "frontend/frame/depth_resampling.h"

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
      if (at[0] >= 0.0F && at[0] < depth.cols + 1 && at[1] >= 0.0F &&
          at[1] < depth.rows + 1) {
        to[u] = EncodeDepth(SampleDepth(padded, at[0], at[1]));
      }
    }
  }
  return resampled;
}

}  // namespace rgbd_pose
