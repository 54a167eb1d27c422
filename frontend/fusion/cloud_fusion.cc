#include "frontend/fusion/cloud_fusion.h"

namespace rgbd_pose {

std::string FusionOptions::Check() const {
  // No sensor is accurate enough for smaller cubes, and with larger ones rooms
  // are no longer recognisable.
  if (!(voxel_size >= 0.001 && voxel_size <= 1.0)) {
    return "the voxel size must be 0.001 to 1 m";
  }
  if (std::string error = depth.Check(); !error.empty()) return error;
  return camera.Check();
}

CloudFusion::CloudFusion(const FusionOptions& options)
    : options_(options), cloud_(static_cast<float>(options.voxel_size)) {
  const Camera& camera = options.camera;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      rays_.push_back(camera.Unproject({x, y}, 1.0).cast<float>());
    }
  }
}

void CloudFusion::Add(const Frame& frame, const Rigid3d& world_from_cam) {
  const Eigen::Matrix3f rotation =
      world_from_cam.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f translation = world_from_cam.translation.cast<float>();
  const auto metres_per_unit = static_cast<float>(1.0 / frame.depth_scale);
  const auto min_depth = static_cast<float>(options_.depth.min_depth);
  const auto max_depth = static_cast<float>(options_.depth.max_depth);
  for (int y = 1; y < frame.depth.rows - 1; ++y) {
    const Eigen::Vector3f* rays =
        &rays_[static_cast<size_t>(y) * frame.depth.cols];
    for (int x = 1; x < frame.depth.cols - 1; ++x) {
      const uint16_t raw = frame.depth.at<uint16_t>(y, x);
      const float z = raw * metres_per_unit;
      if (raw == Frame::kNoDepth || z < min_depth || z > max_depth) continue;
      const double max_step =
          MaxSurfaceStep(z, options_.depth.noise) * frame.depth_scale;
      if (!IsOnSurface(frame.depth, x, y, static_cast<int>(max_step))) continue;
      const cv::Vec3b& bgr = frame.color.at<cv::Vec3b>(y, x);
      cloud_.Add(
          {rotation * (z * rays[x]) + translation, {bgr[2], bgr[1], bgr[0]}});
    }
  }
  ++frames_;
}

}  // namespace rgbd_pose
