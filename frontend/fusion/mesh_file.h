#pragma once

#include <string>
#include <vector>

#include "frontend/fusion/triangle_mesh.h"

namespace rgbd_pose {

// Writes a mesh as the file's ending says, .ply or .glb, as a whole or not at
// all. Throws InputError if it cannot, or for another ending.
void WriteMesh(const std::string& path, const TriangleMesh& mesh);

// Throws InputError if WriteMesh could not write the file: to be said before
// the work rather than after it.
void RequireMeshFile(const std::string& path);

// A mesh as a binary glTF 2.0 file (.glb), coloured and not lit: what was seen
// has its light already. glTF has y up and z towards who looks at it; the world
// of a trajectory, whose first camera has y down, is turned around x.
std::string FormatGlb(const TriangleMesh& mesh);

// A mesh as a PLY file: binary little-endian, per vertex x y z (float, metres)
// and red green blue (uchar), per face three vertex_indices (int). (G. Turk,
// The PLY Polygon File Format, 1994.)
std::string FormatMeshPly(const TriangleMesh& mesh);

// A point cloud: the same without faces.
std::string FormatPly(const std::vector<ColoredPoint>& points);

// Writes it as a whole or not at all. Throws InputError if it cannot.
void WritePly(const std::string& path, const std::vector<ColoredPoint>& points);

}  // namespace rgbd_pose
