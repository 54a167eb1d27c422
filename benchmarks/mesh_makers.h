#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "frontend/fusion/mesh_fusion.h"

namespace rgbd_pose {

// Makes a mesh of frames with known poses.
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

// This project's; then, where it is installed, Open3D's ScalableTSDFVolume with
// the same voxels and depths. Its truncation is the same everywhere, and each
// depth counts alike.
std::vector<MeshMakerType> MeshMakerTypes();

// Where Open3D is installed (open3d_mesh.cc).
std::unique_ptr<MeshMaker> MakeOpen3dMesh(const MeshFusionOptions& options);

}  // namespace rgbd_pose
