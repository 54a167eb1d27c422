#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/frame/undistorter.h"
#include "frontend/fusion/cloud_fusion.h"
#include "frontend/fusion/mesh_file.h"
#include "frontend/fusion/surface_mesh.h"

namespace rgbd_pose {

struct MeshFusionOptions : FusionOptions {
  // Truncation distance around the surface: this number of voxels or of
  // standard deviations of depth, whichever is larger.
  static constexpr double kTruncation = 3.0;

  // Larger depths (m) are not used either: noise spreads each over many voxels.
  double max_depth = 4.0;

  // Number of threads used by Add; the mesh does not depend on it.
  int threads = 1;

  // A one-line description of an error in the options, or empty.
  std::string Check() const;
};

// Fuses the depth images of frames with known poses into a mesh in the world
// frame of their poses: the zero level of a truncated signed distance averaged
// over all frames (B. Curless & M. Levoy, A Volumetric Method for Building
// Complex Models from Range Images, SIGGRAPH 1996). The result is
// deterministic.
class MeshFusion {
 public:
  // The options must pass MeshFusionOptions::Check.
  explicit MeshFusion(const MeshFusionOptions& options);

  // The frame must have colours.
  void Add(const Frame& frame, const Rigid3d& world_from_cam);

  // The surface so far.
  TriangleMesh Mesh() const;

 private:
  // Parameters that depend on a depth.
  struct DepthUse {
    float truncation;  // m
    float weight;      // 1 / m^2
  };

  // The key of a block in view, and whether the surface is too far from it.
  using SeenBlock = std::pair<uint64_t, bool>;

  static constexpr int kDepthStepsPerMetre = 512;

  const DepthUse& UseOf(float depth) const {
    return uses_[static_cast<int>(depth * float{kDepthStepsPerMetre})];
  }
  void KeepSurfacePixels(const Frame& frame);
  std::vector<SeenBlock> FindBlocks(const Rigid3d& world_from_cam) const;
  void AddToBlock(uint64_t key, const Rigid3d& cam_from_world,
                  TsdfVolume::Block* block) const;

  MeshFusionOptions options_;
  Undistorter undistorter_;
  // The table has one entry per step of depth. Few steps keep it in the
  // processor's cache.
  std::vector<DepthUse> uses_;
  double depth_scale_ = 0.0;
  std::vector<int> max_steps_;  // to neighbours, by raw depth; -1: no depth
  cv::Mat depth_;  // of the current frame: CV_32FC1, m; 0: not on a surface
  cv::Mat color_;
  TsdfVolume volume_;
};

}  // namespace rgbd_pose
