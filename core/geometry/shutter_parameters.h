#pragma once

#include <array>

#include "core/geometry/camera.h"
#include "core/geometry/shutter.h"

namespace rgbd_pose {

// A number of a camera's shutters by its name.
struct ShutterParameter {
  const char* name;            // as camera files have it
  Shutter RgbdCamera::*image;  // whose it is
  double Shutter::*value;      // where it is
  double most;                 // no camera has more, either way, s
};

inline constexpr std::array<ShutterParameter, 4> kShutterParameters = {
    {{"color_time_offset", &RgbdCamera::color_shutter, &Shutter::offset, 0.5},
     {"color_readout", &RgbdCamera::color_shutter, &Shutter::readout, 0.1},
     {"depth_time_offset", &RgbdCamera::depth_shutter, &Shutter::offset, 0.5},
     {"depth_readout", &RgbdCamera::depth_shutter, &Shutter::readout, 0.1}}};

}  // namespace rgbd_pose
