#pragma once

#include "frontend/fusion/triangle_mesh.h"
#include "frontend/fusion/tsdf_volume.h"

namespace rgbd_pose {

// The surface in a volume: where the distance is zero. A vertex for each voxel
// that it passes, in the middle of where it crosses the voxel's edges, and two
// triangles for each edge that it crosses (surface nets; S. F. F. Gibson,
// Constrained Elastic Surface Nets, MICCAI 1998). It ends where a corner's
// weight is less than `min_weight` (> 0). `voxel_size` in metres.
TriangleMesh SurfaceMesh(const TsdfVolume& volume, double voxel_size,
                         float min_weight);

// The same surface in at most `max_triangles` (> 0) triangles: vertices that
// share a cube become one, and what is left of triangles stays. Cubes start at
// `voxel_size` (m) and grow until that is so.
TriangleMesh SimplifyMesh(const TriangleMesh& mesh, float voxel_size,
                          size_t max_triangles);

}  // namespace rgbd_pose
