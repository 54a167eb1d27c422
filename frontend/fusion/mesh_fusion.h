#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/frame/undistorter.h"
#include "frontend/fusion/fusion_options.h"
#include "frontend/fusion/triangle_mesh.h"
#include "frontend/fusion/tsdf_volume.h"

namespace rgbd_pose {

// How depth images become one surface.
struct MeshFusionOptions : FusionOptions {
  // Depths beyond (m) are left out, too: noise spreads each over so many voxels
  // that they take most of the time and memory and bring little.
  double max_depth = 4.0;

  // How far around the surface distances are kept: so many voxels, and where
  // the sensor is noisier so many of its standard deviations.
  double truncation_voxels = 3.0;
  double truncation_sigmas = 3.0;

  // What is known of the surface no better than this (m), when all that was
  // seen of it has been taken together, is left out; 0: as good as a voxel is
  // wide.
  double max_sigma = 0.0;

  // Threads that Add works on; the mesh does not depend on it.
  int threads = 1;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Puts the depth images of frames with known poses together to a mesh in the
// world of their poses: the zero of a truncated signed distance, averaged over
// all frames (B. Curless & M. Levoy, A Volumetric Method for Building Complex
// Models from Range Images, SIGGRAPH 1996). The same frames in the same order
// give the same mesh.
class MeshFusion {
 public:
  // The options must be sound, see Check.
  explicit MeshFusion(const MeshFusionOptions& options);

  // The frame must have its colour.
  void Add(const Frame& frame, const Rigid3d& world_from_cam);

  // The surface so far.
  TriangleMesh Mesh() const;

  // What is kept of the frames, in bytes.
  size_t MemoryBytes() const { return volume_.MemoryBytes(); }

 private:
  // What is done with a depth.
  struct DepthUse {
    float truncation;  // m
    float weight;      // 1 / m^2
  };

  // A block that a frame sees.
  struct SeenBlock {
    uint64_t key;
    bool is_near;  // the surface may be in it

    bool operator==(const SeenBlock& other) const {
      return key == other.key && is_near == other.is_near;
    }
  };

  static constexpr int kDepthStepsPerMetre = 512;

  void SetDepthScale(double depth_scale);
  const DepthUse& UseOf(float depth) const {
    return uses_[static_cast<int>(depth * float{kDepthStepsPerMetre})];
  }
  void KeepSurfacePixels(const Frame& frame);
  std::vector<SeenBlock> FindBlocks(const Rigid3d& world_from_cam) const;
  void AddToBlock(uint64_t key, const Rigid3d& cam_from_world,
                  TsdfVolume::Block* block) const;

  MeshFusionOptions options_;
  Undistorter undistorter_;
  // By steps of depth: few, so that the table stays near the processor.
  std::vector<DepthUse> uses_;
  double depth_scale_ = 0.0;
  std::vector<int> max_steps_;  // to neighbours, by raw depth; -1: no depth
  cv::Mat depth_;  // of the frame at hand: CV_32FC1, m, 0 off surfaces
  cv::Mat color_;
  TsdfVolume volume_;
};

}  // namespace rgbd_pose
