#pragma once

#include "core/geometry/depth_noise.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// The depth at a feature; depth 0 = none that can be trusted.
struct DepthSample {
  double depth = 0.0;  // m
  double sigma = 0.0;  // standard deviation, m
};

// Which depths are used, and how uncertain they are.
struct DepthLookupOptions {
  // Of single pixels.
  DepthNoiseModel noise = *FindDepthNoiseModel("khoshelham");

  double min_depth = 0.3;  // m
  double max_depth = 8.0;  // m
};

// The depth at an image point (px, distorted), never mixing two surfaces:
// inverse depth is linear over a plane's image, so a plane is fitted to the
// 3 x 3 neighbours' inverse depths and read at the point itself. Neighbours
// that do not lie on one surface (their spread exceeds the noise) give none. A
// neighbourhood with holes gives the nearest pixel's depth, if the others agree
// with it.
DepthSample LookUpDepth(const Frame& frame, double u, double v,
                        const DepthLookupOptions& options);

}  // namespace rgbd_pose
