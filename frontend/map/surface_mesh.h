#pragma once

#include "frontend/map/distance_volume.h"
#include "frontend/map/triangle_mesh.h"

namespace rgbd_pose {

// The surface in a volume: where the distance is zero. A vertex for each voxel
// that it passes, in the middle of where it crosses the voxel's edges, and two
// triangles for each edge that it crosses (surface nets; S. F. F. Gibson,
// Constrained Elastic Surface Nets, MICCAI 1998). It ends where a corner's
// weight is less than `min_weight` (> 0). `voxel_size` in metres.
TriangleMesh SurfaceMesh(const DistanceVolume& volume, double voxel_size,
                         float min_weight);

}  // namespace rgbd_pose
