#include "frontend/map/cloud_fusion.h"

#include <cmath>

namespace rgbd_pose {
namespace {

constexpr double kRadFromDeg = M_PI / 180.0;

// Below, there are more cubes than any sensor has noise-free points for;
// above, rooms are no longer recognised.
constexpr double kMinVoxelSize = 0.001;  // m
constexpr double kMaxVoxelSize = 1.0;    // m

// Neighbouring pixels on one surface differ by noise and by slope. Noise: 4
// standard deviations of a difference, which has sqrt(2) times that of a depth.
// Slope: a surface seen at 80 degrees, at f = 525 px.
constexpr double kMaxNoiseStep = 4.0 * M_SQRT2;  // of the depth's sigma
constexpr double kMaxSlopeStep = 0.011;          // of the depth

// A pixel with fewer neighbours (of 4) hangs in the air.
constexpr int kMinNeighbours = 2;

// Whether a pixel lies on a surface with its neighbours. At the edges of
// objects sensors report depths between the object and what is behind it.
bool IsOnSurface(const cv::Mat& depth, int x, int y, double metres_per_unit,
                 const DepthNoiseModel& noise) {
  const int raw = depth.at<uint16_t>(y, x);
  const double z = raw * metres_per_unit;
  const double limit =
      (kMaxNoiseStep * noise.sigma(z) + kMaxSlopeStep * z) / metres_per_unit;
  int neighbours = 0;
  for (const uint16_t other :
       {depth.at<uint16_t>(y, x - 1), depth.at<uint16_t>(y, x + 1),
        depth.at<uint16_t>(y - 1, x), depth.at<uint16_t>(y + 1, x)}) {
    if (other == 0 || other == Frame::kNoDepth) continue;
    if (std::abs(other - raw) > limit) return false;
    ++neighbours;
  }
  return neighbours >= kMinNeighbours;
}

}  // namespace

std::string CloudFusionOptions::Check() const {
  if (!(voxel_size >= kMinVoxelSize && voxel_size <= kMaxVoxelSize)) {
    return "the voxel size must be 0.001 to 1 m";
  }
  if (depth.noise == nullptr) return "a depth noise model is needed";
  if (!(depth.min_depth > 0.0) || !(depth.max_depth > depth.min_depth)) {
    return "depth limits must satisfy 0 < min_depth < max_depth";
  }
  return camera.Check();
}

CloudFusion::CloudFusion(const CloudFusionOptions& options)
    : options_(options), cloud_(static_cast<float>(options.voxel_size)) {
  const Camera& camera = options.camera;
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) pixels.emplace_back(x, y);
  }
  camera.UndistortPoints(&pixels);
  rays_.reserve(pixels.size());
  for (const Eigen::Vector2d& pixel : pixels) {
    rays_.push_back(camera.Ray(pixel.x(), pixel.y()).cast<float>());
  }
}

bool CloudFusion::Wants(const TrackedFrame& tracked) const {
  if (tracked.status != TrackingStatus::kOk || tracked.segment != 0) {
    return false;
  }
  if (!last_world_from_cam_.has_value()) return true;
  const Rigid3d last_from_cam =
      last_world_from_cam_->Inverse() * tracked.world_from_cam;
  return last_from_cam.translation.norm() >= options_.min_distance ||
         last_from_cam.Angle() >= options_.min_angle_deg * kRadFromDeg;
}

void CloudFusion::Add(const Frame& frame, const Rigid3d& world_from_cam) {
  const Eigen::Matrix3f rotation =
      world_from_cam.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = world_from_cam.translation.cast<float>();
  const auto metres_per_unit = static_cast<float>(1.0 / frame.depth_scale);
  const auto min_depth = static_cast<float>(options_.depth.min_depth);
  const auto max_depth = static_cast<float>(options_.depth.max_depth);
  ColoredPoint point;
  for (int y = 1; y < frame.depth.rows - 1; ++y) {
    const Eigen::Vector3f* rays =
        &rays_[static_cast<size_t>(y) * frame.depth.cols];
    for (int x = 1; x < frame.depth.cols - 1; ++x) {
      const uint16_t raw = frame.depth.at<uint16_t>(y, x);
      const float z = raw * metres_per_unit;
      if (raw == Frame::kNoDepth || z < min_depth || z > max_depth ||
          !IsOnSurface(frame.depth, x, y, metres_per_unit,
                       *options_.depth.noise)) {
        continue;
      }
      point.position = rotation * (z * rays[x]) + translation;
      const cv::Vec3b& bgr = frame.color.at<cv::Vec3b>(y, x);
      point.blue = bgr[0];
      point.green = bgr[1];
      point.red = bgr[2];
      cloud_.Add(point);
    }
  }
  last_world_from_cam_ = world_from_cam;
  ++frames_;
}

}  // namespace rgbd_pose
