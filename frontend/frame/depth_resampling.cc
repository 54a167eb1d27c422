#include "frontend/frame/depth_resampling.h"

namespace rgbd_pose {

cv::Mat ResampleDepth(const cv::Mat& depth, const cv::Size& size,
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
