#include "frontend/frame/undistorter.h"

#include <opencv2/imgproc.hpp>

namespace rgbd_pose {

Undistorter::Undistorter(const Camera& camera) : ideal_(camera) {
  ideal_.SetDistortion(LensModel::kRational, {0.0, 0.0, 0.0, 0.0});
  if (!camera.HasDistortion()) return;
  constexpr double kMaxErrorPx = 0.5;
  map_x_.create(camera.height, camera.width, CV_32FC1);
  map_y_.create(camera.height, camera.width, CV_32FC1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      Eigen::Vector2d pixel = camera.Project(ideal_.Ray(x, y));
      // Where the distortion cannot be inverted, the image would appear twice.
      const Eigen::Vector2d back = camera.Undistort(pixel);
      if (!((back - Eigen::Vector2d(x, y)).norm() < kMaxErrorPx)) {
        pixel.setConstant(-2.0);  // outside
      }
      map_x_.at<float>(y, x) = static_cast<float>(pixel.x());
      map_y_.at<float>(y, x) = static_cast<float>(pixel.y());
    }
  }
}

Frame Undistorter::Undistort(const Frame& frame) const {
  if (map_x_.empty()) return frame;
  Frame ideal = frame;
  const auto remap = [this](const cv::Mat& image, int interpolation) {
    cv::Mat moved;
    if (!image.empty()) cv::remap(image, moved, map_x_, map_y_, interpolation);
    return moved;
  };
  ideal.gray = remap(frame.gray, cv::INTER_LINEAR);
  ideal.color = remap(frame.color, cv::INTER_LINEAR);
  ideal.depth = remap(frame.depth, cv::INTER_NEAREST);
  return ideal;
}

}  // namespace rgbd_pose
