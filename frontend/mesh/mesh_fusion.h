#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/image/depth_lookup.h"
#include "frontend/image/frame.h"
#include "frontend/map/triangle_mesh.h"

namespace rgbd_pose {

// How depth images become one surface.
struct MeshFusionOptions {
  Camera camera;  // of all frames; may have distortion

  // Side of the cubes (m) in which distances to the surface are kept: details
  // of this size are left.
  double voxel_size = 0.01;

  // Which depths are used, and how much each counts: by 1 / sigma^2.
  DepthLookupOptions depth;

  // How far around the surface distances are kept: so many voxels, and where
  // the sensor is noisier so many of its standard deviations.
  double truncation_voxels = 3.0;
  double truncation_sigmas = 3.0;

  // What is known of the surface no better than this (m), when all that was
  // seen of it has been taken together, is left out; 0: as good as a voxel is
  // wide.
  double max_sigma = 0.0;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Puts the depth images of frames with known poses together to a mesh in the
// world of their poses: the zero of a truncated signed distance, averaged over
// all frames (B. Curless & M. Levoy, A Volumetric Method for Building Complex
// Models from Range Images, SIGGRAPH 1996). Kept in blocks of OpenVDB, so
// memory grows with the surface seen. The same frames in the same order give
// the same mesh.
class MeshFusion {
 public:
  // The options must be sound, see Check.
  explicit MeshFusion(const MeshFusionOptions& options);
  ~MeshFusion();

  // The frame must have its colour.
  void Add(const Frame& frame, const Rigid3d& world_from_cam);

  // The surface so far.
  TriangleMesh Mesh() const;

  // What is kept of the frames, in bytes.
  size_t MemoryBytes() const;

 private:
  struct Volume;
  std::unique_ptr<Volume> volume_;
};

}  // namespace rgbd_pose
