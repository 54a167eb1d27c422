#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/util/units.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"
#include "frontend/fusion/voxel_cloud.h"

namespace rgbd_pose {

// The options that clouds and meshes share.
struct FusionOptions {
  Camera camera;  // of all frames

  // Side of the cubes in which points are merged, or at whose corners distances
  // to the surface are stored (m): the size of the smallest details. If it is
  // finer than the noise of the sensor, the result has only more noise.
  double voxel_size = 0.01;

  // Limits of depth and the noise model. The latter gives the allowed
  // difference of neighbours and the weight of a depth, 1 / sigma^2.
  DepthLookupOptions depth;

  // A one-line description of an error in the options, or empty.
  std::string Check() const;
};

// The motion of a camera after which the next view is worth processing. With a
// field of view of 57 degrees, 5 % of the view is new after a rotation of 3
// degrees, or after 5 cm at a distance of 1 m.
struct MotionFilter {
  double min_distance = 0.05;  // m
  double min_angle_deg = 3.0;  // either limit is sufficient

  // Whether a motion is that large.
  bool IsReached(const Rigid3d& last_from_cur) const {
    return last_from_cur.translation.norm() >= min_distance ||
           last_from_cur.Angle() * kDegreesPerRadian >= min_angle_deg;
  }
};

// Fuses depth images into a coloured point cloud in the world of their poses.
class CloudFusion {
 public:
  // The options must pass FusionOptions::Check.
  explicit CloudFusion(const FusionOptions& options);

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
};

}  // namespace rgbd_pose
