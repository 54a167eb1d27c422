#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "frontend/fusion/mesh_fusion.h"

namespace rgbd_pose {

// Makes a mesh from frames with known poses.
class MeshMaker {
 public:
  virtual ~MeshMaker() = default;
  virtual void Add(const Frame& frame, const Rigid3d& world_from_cam) = 0;
  virtual TriangleMesh Mesh() = 0;
};

struct MeshMakerType {
  std::string name;
  std::unique_ptr<MeshMaker> (*make)(const MeshFusionOptions& options);
};

// This project's; then, if Open3D is installed, its ScalableTSDFVolume with the
// same voxels and depths. Open3D's truncation is constant, and all depths have
// the same weight.
std::vector<MeshMakerType> MeshMakerTypes();

// Defined if Open3D is installed (open3d_mesh.cc).
std::unique_ptr<MeshMaker> MakeOpen3dMesh(const MeshFusionOptions& options);

}  // namespace rgbd_pose
