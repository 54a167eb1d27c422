#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "frontend/fusion/mesh_file.h"

namespace rgbd_pose {

// More points would make the page large and slow; vertex indices have 16 bits.
constexpr int kMaxPreviewPoints = 30000;
constexpr int kMaxPreviewTriangles = 60000;
constexpr int kMaxPreviewVertices = 65535;

// The files in a run's folder with the results of these functions.
constexpr char kCloudPreviewFile[] = "cloud_preview.json";
constexpr char kMeshPreviewFile[] = "mesh_preview.json";

// Returns points for the page of a run. `positions` has x, y, z in multiples of
// `step_m` from `origin_m` (16 bits, low byte first), `colors` red, green, blue
// (8 bits), both in base64.
nlohmann::json CloudPreview(const std::vector<ColoredPoint>& points);

// The same for the vertices of a mesh, with the number of `triangles` and their
// vertex indices, `corners` (16 bits, low byte first), in base64.
nlohmann::json MeshPreview(const TriangleMesh& mesh);

}  // namespace rgbd_pose
