#pragma once

#include "frontend/fusion/triangle_mesh.h"
#include "frontend/fusion/tsdf_volume.h"

namespace rgbd_pose {

// The surface in a volume: the zero level of the distance. Each voxel that it
// passes gets a vertex, the mean of the surface's crossings of the voxel's
// edges. Each crossed edge gets two triangles (surface nets; S. F. F. Gibson,
// Constrained Elastic Surface Nets, MICCAI 1998). The surface ends where a
// corner's weight is less than `min_weight` (> 0). `voxel_size` in metres.
TriangleMesh SurfaceMesh(const TsdfVolume& volume, double voxel_size,
                         float min_weight);

// Simplifies a surface to at most `max_triangles` (> 0) triangles. Vertices in
// the same cube are merged, and degenerate triangles are removed. The size of
// cubes grows from `voxel_size` (m) until the limit is met.
TriangleMesh SimplifyMesh(const TriangleMesh& mesh, float voxel_size,
                          size_t max_triangles);

}  // namespace rgbd_pose
