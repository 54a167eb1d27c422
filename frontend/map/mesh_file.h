#pragma once

#include <string>

#include "frontend/map/triangle_mesh.h"

namespace rgbd_pose {

// Writes a mesh as the file's ending says, .ply or .glb, as a whole or not at
// all. Throws InputError if it cannot, or for another ending.
void WriteMesh(const std::string& path, const TriangleMesh& mesh);

// Throws InputError if WriteMesh could not write the file: to be told before
// the work rather than after it.
void RequireMeshFile(const std::string& path);

}  // namespace rgbd_pose
