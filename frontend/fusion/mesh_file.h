#pragma once

#include <string>

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

// Writes it as a whole or not at all. Throws InputError if it cannot.
void WriteGlb(const std::string& path, const TriangleMesh& mesh);

}  // namespace rgbd_pose
