#pragma once

#include "core/geometry/shutter.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// When the images of an RGB-D frame were taken, and how the camera moved
// meanwhile: what it takes to say where things were seen at the frame's stamp.
struct FrameTiming {
  Shutter color;  // from the frame's stamp
  Shutter depth;  // from the frame's stamp, too
  Twist twist;    // at the stamp

  // Whether all was seen at the stamp.
  bool IsOneMoment() const { return color.IsGlobal() && depth.IsGlobal(); }
};

}  // namespace rgbd_pose
