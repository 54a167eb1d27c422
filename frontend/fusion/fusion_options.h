#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "frontend/frame/depth_lookup.h"

namespace rgbd_pose {

// What depth images are put together by.
struct FusionOptions {
  Camera camera;  // of all frames

  // Side of the cubes that points are merged in, or at whose corners distances
  // to the surface are kept (m): details of this size are left. Finer than the
  // noise of the sensor, more noise is held, not more detail.
  double voxel_size = 0.01;

  // Which depths are used, how far noise puts neighbours apart, and how much
  // each counts: by 1 / sigma^2.
  DepthLookupOptions depth;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
