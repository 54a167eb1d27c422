#include "frontend/sources/source_options.h"

#include <cmath>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

bool IsScale(double scale) { return std::isfinite(scale) && scale > 0.0; }

std::string ProblemOf(const CameraSetup& setup) {
  const std::string problem = setup.camera.Check();
  return !problem.empty() || IsScale(setup.depth_scale.value_or(1.0))
             ? problem
             : "the depth scale must be a positive number";
}

}  // namespace

std::string SourceOptions::Check() const {
  if (camera.has_value()) {
    const std::string problem = ProblemOf(*camera);
    if (!problem.empty()) return "camera: " + problem;
  }
  if (depth_scale != 0.0 && !IsScale(depth_scale)) {
    return "depth_scale must be positive (raw units per metre)";
  }
  if (!(max_time_difference >= 0.0)) {
    return "the time difference must not be negative";
  }
  return "";
}

CameraSetup ChooseCamera(const SourceOptions& options,
                         const std::optional<CameraSetup>& of_recording) {
  RequireSound(options.Check());
  if (!options.camera.has_value() && !of_recording.has_value()) {
    throw InputError(options.path +
                     ": contains no camera calibration; give a preset or a "
                     "calibration file (camera)");
  }
  CameraSetup chosen =
      options.camera.has_value() ? *options.camera : *of_recording;
  if (of_recording.has_value()) {
    if (!chosen.depth_scale) chosen.depth_scale = of_recording->depth_scale;
    if (!chosen.depth_camera) chosen.depth_camera = of_recording->depth_camera;
  }
  if (options.depth_scale > 0.0) chosen.depth_scale = options.depth_scale;
  const std::string problem = ProblemOf(chosen);
  if (!problem.empty()) {
    throw InputError(options.path + ": invalid camera: " + problem +
                     "; give a preset or a calibration file (camera)");
  }
  return chosen;
}

}  // namespace rgbd_pose
