#include "frontend/tracking/residual_image.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "frontend/frame/image_pyramid.h"

namespace rgbd_pose {
namespace {

constexpr double kFullColor = 20.0;  // grey levels
// Grey levels that agree use only the lower half of the scale, which makes
// colours stand out.
constexpr double kDimmed = 0.5;

}  // namespace

cv::Mat DrawResiduals(const FrameView& reference, const Frame& frame,
                      const Rigid3d& cur_from_ref) {
  const auto& [gray, camera] = reference.levels[1];
  // Where the frame sees each pixel of level 1 of the reference: px of level 1
  // of the frame.
  cv::Mat places(gray.height, gray.width, CV_32FC2, cv::Scalar::all(-1.0));
  cv::Mat valid(places.size(), CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < places.rows; ++v) {
    for (int u = 0; u < places.cols; ++u) {
      const double depth = reference.DepthAt(2 * u + 1, 2 * v + 1);
      if (depth <= 0.0) continue;
      const Eigen::Vector3d point =
          cur_from_ref * camera.Unproject(Eigen::Vector2d(u, v), depth);
      if (!(point.z() > 0.0)) continue;
      const Eigen::Vector2d pixel = camera.Project(point);
      if (!camera.Contains(pixel)) continue;
      places.at<cv::Vec2f>(v, u) = {static_cast<float>(pixel.x()),
                                    static_cast<float>(pixel.y())};
      valid.at<uint8_t>(v, u) = 255;
    }
  }
  const SmoothPyramid pyramid{PreparedFrame(frame)};
  cv::Mat seen;
  cv::remap(pyramid.levels[1], seen, places, cv::Mat(), cv::INTER_LINEAR);
  const cv::Mat before(gray.height, gray.width, CV_8UC1,
                       const_cast<uint8_t*>(gray.data), gray.stride);
  cv::Scalar mean_before, deviation_before, mean_now, deviation_now;
  cv::meanStdDev(before, mean_before, deviation_before, valid);
  cv::meanStdDev(seen, mean_now, deviation_now, valid);
  const double gain =
      deviation_before[0] > 1.0 ? deviation_now[0] / deviation_before[0] : 1.0;
  cv::Mat picture(places.size(), CV_8UC3, cv::Scalar::all(0));
  for (int v = 0; v < places.rows; ++v) {
    for (int u = 0; u < places.cols; ++u) {
      if (valid.at<uint8_t>(v, u) == 0) continue;
      const double now = seen.at<uint8_t>(v, u);
      const double expected =
          mean_now[0] + gain * (before.at<uint8_t>(v, u) - mean_before[0]);
      const double off = std::clamp((now - expected) / kFullColor, -1.0, 1.0);
      const double plain = kDimmed * now * (1.0 - std::abs(off));
      const cv::Vec3d color(plain + 255.0 * std::max(0.0, -off), plain,
                            plain + 255.0 * std::max(0.0, off));
      picture.at<cv::Vec3b>(v, u) = color;
    }
  }
  return picture;
}

}  // namespace rgbd_pose
