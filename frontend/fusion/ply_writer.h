#pragma once

#include <string>
#include <vector>

#include "frontend/fusion/triangle_mesh.h"

namespace rgbd_pose {

// A point cloud as a PLY file: binary little-endian, per vertex x y z (float,
// metres) and red green blue (uchar). (G. Turk, The PLY Polygon File Format,
// 1994.)
std::string FormatPly(const std::vector<ColoredPoint>& points);

// A mesh: the same, and per face three vertex_indices (int).
std::string FormatMeshPly(const TriangleMesh& mesh);

// Writes it as a whole or not at all. Throws InputError if it cannot.
void WritePly(const std::string& path, const std::vector<ColoredPoint>& points);
void WriteMeshPly(const std::string& path, const TriangleMesh& mesh);

}  // namespace rgbd_pose
