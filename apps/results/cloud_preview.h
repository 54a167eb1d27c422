#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/fusion/triangle_mesh.h"

namespace rgbd_pose {

// More points would make the page large and slow to rotate.
constexpr int kMaxPreviewPoints = 30000;

// The file in a run's folder with the result of CloudPreview.
constexpr char kCloudPreviewFile[] = "cloud_preview.json";

// Returns points for the page of a run, transformed by `shown_from_world`.
// `positions` holds x, y, z in integer multiples of `step_m` from `origin_m`
// (16 bits, low byte first), `colors` red, green, blue (8 bits), both in
// base64.
nlohmann::json CloudPreview(const std::vector<ColoredPoint>& points,
                            const Rigid3d& shown_from_world);

// Limits for meshes, for the same reason. Vertex indices have 16 bits.
constexpr int kMaxPreviewTriangles = 60000;
constexpr int kMaxPreviewVertices = 65535;

// The file in a run's folder with the result of MeshPreview.
constexpr char kMeshPreviewFile[] = "mesh_preview.json";

// The same for the vertices of a mesh, as they are. In addition, `triangles` is
// the number of triangles and `corners` holds their vertex indices (16 bits
// each, low byte first) in base64.
nlohmann::json MeshPreview(const TriangleMesh& mesh);

}  // namespace rgbd_pose
