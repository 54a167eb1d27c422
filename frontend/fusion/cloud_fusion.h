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

// Puts the depth images of tracked frames together to a coloured point cloud
// in the world of their poses.
class CloudFusion {
 public:
  // The options must be sound, see Check.
  explicit CloudFusion(const FusionOptions& options);

  // Whether Add would bring anything new: the status is ok, the camera has
  // moved, and how the frame lies to the first one is known (its segment).
  bool ShouldIntegrate(const TrackedFrame& tracked) const;

  // The frame must have its colour.
  void Add(const Frame& frame, const Rigid3d& world_from_cam);

  // What has come together, and of how many frames.
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
