#include "apps/view/view_points.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "frontend/fusion/little_endian.h"

namespace rgbd_pose {
namespace {

// So many across the image: some 2,000 in all.
constexpr int kColumns = 53;

// Depth cameras see little that is right beyond, m.
constexpr double kMaxDepth = 6.0;

}  // namespace

std::string SamplePoints(const Frame& frame, const Camera& camera) {
  const int step = std::max(1, frame.gray.cols / kColumns);
  std::vector<cv::Point> pixels;
  for (int v = step / 2; v < frame.gray.rows; v += step) {
    for (int u = step / 2; u < frame.gray.cols; u += step) {
      pixels.emplace_back(u, v);
    }
  }
  std::shuffle(pixels.begin(), pixels.end(), std::mt19937(1));
  std::string bytes;
  for (const cv::Point& pixel : pixels) {
    const double depth = frame.DepthAt(pixel.x, pixel.y);
    if (!(depth > 0.0) || depth > kMaxDepth) continue;
    const Eigen::Vector2d ideal = camera.Undistort({pixel.x, pixel.y});
    const Eigen::Vector3d point = depth * camera.Ray(ideal.x(), ideal.y());
    if (!(point.cwiseAbs().maxCoeff() < 32.0)) continue;
    for (const double metres : {point.x(), point.y(), point.z()}) {
      AppendLittleEndian(static_cast<uint16_t>(
                             static_cast<int16_t>(std::lround(1e3 * metres))),
                         &bytes);
    }
    bytes += static_cast<char>(frame.gray.at<uint8_t>(pixel));
  }
  return bytes;
}

}  // namespace rgbd_pose
