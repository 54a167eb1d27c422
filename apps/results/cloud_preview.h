#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/fusion/triangle_mesh.h"

namespace rgbd_pose {

// A page with more points than this would be large and turn slowly.
constexpr int kMaxPreviewPoints = 30000;

// In the folder of a run, what CloudPreview returns.
constexpr char kCloudPreviewFile[] = "cloud_preview.json";

// Points for the page of a run, moved by `shown_from_world`: `positions` are
// their x, y, z in whole steps of `step_m` from `origin_m` (16 bits each, low
// byte first), `colors` red, green, blue (8 bits each), both in base64.
nlohmann::json CloudPreview(const std::vector<ColoredPoint>& points,
                            const Rigid3d& shown_from_world);

// A mesh of more triangles than this would, too; its vertices can be counted
// in 16 bits.
constexpr int kMaxPreviewTriangles = 60000;
constexpr int kMaxPreviewVertices = 65535;

// In the folder of a run, what MeshPreview returns.
constexpr char kMeshPreviewFile[] = "mesh_preview.json";

// The same of a mesh's vertices, and `triangles`: how many; `corners`: their
// places among the vertices (16 bits each, low byte first), in base64.
nlohmann::json MeshPreview(const TriangleMesh& mesh,
                           const Rigid3d& shown_from_world);

}  // namespace rgbd_pose
