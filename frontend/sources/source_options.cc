#include "frontend/sources/source_options.h"

#include <cmath>

#include "core/util/input_error.h"

namespace rgbd_pose {

std::string SourceOptions::Check() const {
  const auto is_scale = [](double scale) {
    return std::isfinite(scale) && scale > 0.0;
  };
  if (camera.has_value()) {
    const std::string problem = camera->camera.Check();
    if (!problem.empty()) return "camera: " + problem;
    if (camera->depth_scale.has_value() && !is_scale(*camera->depth_scale)) {
      return "the depth scale must be a positive number";
    }
  }
  if (depth_scale != 0.0 && !is_scale(depth_scale)) {
    return "depth_scale must be positive (raw units per metre)";
  }
  if (!(max_time_difference >= 0.0)) {
    return "the time difference must not be negative";
  }
  return "";
}

CameraSetup ChooseCamera(const SourceOptions& options,
                         const std::optional<CameraSetup>& of_recording) {
  const std::string problem = options.Check();
  if (!problem.empty()) throw InputError(problem);
  if (!options.camera.has_value() && !of_recording.has_value()) {
    throw InputError(options.path +
                     ": does not say what camera it is of; name a preset or a "
                     "calibration file (camera)");
  }
  CameraSetup chosen =
      options.camera.has_value() ? *options.camera : *of_recording;
  if (of_recording.has_value()) {
    if (!chosen.depth_scale) chosen.depth_scale = of_recording->depth_scale;
    if (!chosen.depth_camera) chosen.depth_camera = of_recording->depth_camera;
  }
  if (options.depth_scale > 0.0) chosen.depth_scale = options.depth_scale;
  return chosen;
}

}  // namespace rgbd_pose
