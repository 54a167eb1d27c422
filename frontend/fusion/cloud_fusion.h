#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/fusion/fusion_options.h"
#include "frontend/fusion/voxel_cloud.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// Fuses the depth images of tracked frames into a coloured point cloud in the
// world frame of their poses.
class CloudFusion {
 public:
  // The options must pass FusionOptions::Check.
  explicit CloudFusion(const FusionOptions& options);

  // Whether Add would contribute anything new: the status is ok, the camera has
  // moved, and the pose relative to the first frame is known (segment 0).
  bool ShouldIntegrate(const TrackedFrame& tracked) const;

  // The frame must have colours.
  void Add(const Frame& frame, const Rigid3d& world_from_cam);

  // The points so far, and the number of fused frames.
  const VoxelCloud& cloud() const { return cloud_; }
  int frames() const { return frames_; }

 private:
  FusionOptions options_;
  std::vector<Eigen::Vector3f> rays_;  // of all pixels at depth 1, row by row
  VoxelCloud cloud_;
  int frames_ = 0;
  std::optional<Rigid3d> last_world_from_cam_;
};

}  // namespace rgbd_pose
