#pragma once

#include "frontend/map/triangle_mesh.h"

namespace rgbd_pose {

// The same surface in at most `max_triangles` (> 0) triangles: vertices that
// share a cube become one, and what is left of triangles stays. Cubes start at
// `voxel_size` (m) and grow until that is so.
TriangleMesh ThinMesh(const TriangleMesh& mesh, float voxel_size,
                      size_t max_triangles);

}  // namespace rgbd_pose
