#pragma once

#include <functional>

#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_renderer.h"

namespace rgbd_pose {

// How long a camera gathers light, and how much its image is amplified.
struct Exposure {
  double shutter_s = 0.0;  // 0: the image of an instant
  double gain = 1.0;
  double readout_s = 0.0;  // see Shutter
};

// The gain at time t (s) of an automatic exposure that swings slowly around 1:
// exp(amplitude * sin(2 pi t / kExposurePeriod)).
constexpr double kExposurePeriod = 4.0;  // s
double DriftingGain(double amplitude, double t);

// What a camera on a path world_from_cam(t) sees at time t. Colour is the mean
// of an odd number of renderings, evenly spread over the shutter time with t in
// its middle and never much more than kMaxBlurStep apart in the image, times
// the gain, rounded once and cut off at 255. Depth is that of time t. Gray
// levels are taken as proportional to light. With a rolling shutter t is the
// time of the middle row, of both images, and each band of rows (see Renderer)
// is seen at the time of its own middle.
constexpr double kMaxBlurStep = 2.0;  // px; finer than that the lens blurs
Rendering Expose(const Renderer& renderer, double focal_px,
                 const std::function<Rigid3d(double t)>& world_from_cam,
                 double t, const Exposure& exposure);

}  // namespace rgbd_pose
