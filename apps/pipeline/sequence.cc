#include "apps/pipeline/sequence.h"

#include <filesystem>

#include "core/util/input_error.h"
#include "frontend/sources/camera_file.h"
#include "frontend/sources/open_source.h"

namespace rgbd_pose {

std::vector<Setting> SettingTable(SequenceSettings* settings) {
  constexpr std::string_view kGroup = "Input";
  return {
      {"dataset", kGroup,
       "recording of an RGB-D camera: a folder in TUM RGB-D layout",
       Text(&settings->dataset)},
      {"source", kGroup, "kind of recording", Text(&settings->source),
       SourceNames()},
      {"associations", kGroup,
       "file that pairs colour and depth images, either column order; empty: "
       "rgb.txt and depth.txt are paired by time",
       Text(&settings->associations)},
      {"camera", kGroup,
       "YAML file (ORB-SLAM2/3, ROS camera_info or Kalibr layout) or preset",
       Text(&settings->camera), CameraPresetNames()},
      {"depth_scale", kGroup,
       "raw depth units per metre; 0: as the camera says",
       &settings->depth_scale},
      {"motion_guess", kGroup,
       "trajectory (TUM text) that tells roughly how the camera moved between "
       "frames: wheels, an inertial sensor; empty: none",
       Text(&settings->motion_guess)},
      {"groundtruth", kGroup,
       "trajectory to compare with (TUM text); empty: groundtruth.txt of the "
       "dataset if it is there",
       Text(&settings->groundtruth)},
  };
}

RunInputs Sequence::inputs() const {
  return {motion_guess.has_value() ? &*motion_guess : nullptr,
          ground_truth.has_value() ? &*ground_truth : nullptr};
}

Sequence OpenSequence(const SequenceSettings& settings, bool keep_color) {
  SourceOptions options;
  options.path = settings.dataset;
  options.keep_color = keep_color;
  options.associations_file = settings.associations;
  options.camera = ResolveCamera(settings.camera);
  if (!(settings.depth_scale >= 0.0)) {
    throw InputError("depth_scale must be positive (raw units per metre)");
  }
  if (settings.depth_scale > 0.0) {
    options.camera.depth_scale = settings.depth_scale;
  }
  Sequence sequence;
  sequence.source = OpenSource(settings.source, options);
  std::string truth = settings.groundtruth;
  if (truth.empty()) {
    const std::filesystem::path path =
        std::filesystem::path(settings.dataset) / "groundtruth.txt";
    if (std::filesystem::exists(path)) truth = path.string();
  }
  if (!truth.empty()) {
    sequence.ground_truth = ReadTrajectory(truth);
    RequireOverlap(*sequence.source, *sequence.ground_truth);
  }
  if (!settings.motion_guess.empty()) {
    sequence.motion_guess.emplace(ReadTrajectory(settings.motion_guess));
  }
  return sequence;
}

}  // namespace rgbd_pose
