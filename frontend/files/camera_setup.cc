#include "frontend/files/camera_setup.h"

namespace rgbd_pose {

RgbdCamera RegisteredCamera(const CameraSetup& setup) {
  return {setup.camera, setup.depth_scale.value_or(RgbdCamera{}.depth_scale),
          setup.depth_correction, setup.color_shutter, setup.depth_shutter};
}

}  // namespace rgbd_pose
