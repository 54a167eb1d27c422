#include "frontend/settings/sequence.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/evaluation/association.h"
#include "core/evaluation/evaluation.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/open_source.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

SourceOptions OptionsOf(const SequenceSettings& settings, bool keep_color,
                        const RgbdCamera* camera) {
  SourceOptions options;
  options.path = settings.dataset;
  options.keep_color = keep_color;
  options.associations_file = settings.associations;
  if (!settings.topics.empty()) options.topics = SplitList(settings.topics);
  options.depth_scale = settings.depth_scale;
  options.imu = settings.imu;
  if (!settings.camera.empty()) {
    options.camera = ResolveCameraSetup(settings.camera, settings.depth_camera);
  } else if (!settings.depth_camera.empty()) {
    throw InputError(
        "depth_camera '" + settings.depth_camera +
        "': needs a Kalibr file with this camera as camera (--camera), even if "
        "it is the recording's own");
  }
  if (camera != nullptr) {
    const CameraSetup said = options.camera.value_or(CameraSetup());
    options.camera.emplace(*camera).depth_camera = said.depth_camera;
    options.camera->is_upside_down = said.is_upside_down;
    options.camera->imu = said.imu;
    options.depth_scale = 0.0;
  }
  return options;
}

// Reads the ground truth if it is available before the frames. Throws
// InputError if no frame, as far as they are known, is near it in time.
void FindTruth(const SequenceSettings& settings, Sequence* sequence) {
  try {
    if (!settings.groundtruth.empty()) {
      sequence->ground_truth =
          ReadTrajectory(settings.groundtruth, &sequence->remarks);
    } else if (!sequence->source->timestamps().empty()) {
      Trajectory truth = sequence->source->ground_truth();
      if (!truth.empty()) sequence->ground_truth = std::move(truth);
    }
    Trajectory frames;
    for (const double time : sequence->source->timestamps()) {
      frames.push_back({time, {}});
    }
    if (sequence->ground_truth.has_value() && !frames.empty()) {
      PairPoses(frames, *sequence->ground_truth,
                EvaluationOptions().max_time_difference);
    }
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) +
                     "; use --groundtruth=none to run without it");
  }
}

// The noise of the truth that FindTruth finds.
TruthNoise FindTruthNoise(const SequenceSettings& settings) {
  const std::string file =
      !settings.groundtruth.empty()
          ? settings.groundtruth
          : (fs::path(settings.dataset) / "groundtruth.txt").string();
  return PathExists(file) ? ReadTruthNoise(file)
                          : TruthNoiseByName(settings.dataset);
}

}  // namespace

std::vector<Setting> SettingTable(SequenceSettings* settings) {
  constexpr std::string_view kGroup = "Input";
  return {
      {"dataset", kGroup,
       "recording of an RGB-D camera: a folder or file of a known kind (see "
       "source)",
       &settings->dataset},
      {"source", kGroup, "kind of recording; auto: detected", &settings->source,
       SourceNames()},
      {"frames", kGroup,
       "part of the recording: first-last[:step] by number from 0, such as "
       "100-400:2, or by seconds from its start, such as 2.5s-10s; empty: all",
       &settings->frames},
      {"associations", kGroup,
       "file that pairs colour and depth images, either column order; empty: "
       "rgb.txt and depth.txt are paired by time",
       &settings->associations},
      {"topics", kGroup,
       "topics of a bag: COLOUR,DEPTH or COLOUR,DEPTH,CAMERA_INFO; empty: "
       "chosen by type and name",
       &settings->topics},
      {"camera", kGroup,
       "YAML file (ORB-SLAM2/3, ROS camera_info or Kalibr layout) or preset; "
       "empty: the camera stored in the recording",
       &settings->camera, CameraPresetNames()},
      {"depth_camera", kGroup,
       "camera of a multi-camera Kalibr file that took the depth images: with "
       "cam1, for example, they are registered to colour; cam0: they are "
       "already registered",
       &settings->depth_camera},
      {"depth_scale", kGroup,
       "raw depth units per metre; 0: from the camera or the recording",
       &settings->depth_scale},
      {"imu", kGroup,
       "YAML file that says mounting, delay or noise of the inertial sensor "
       "(Kalibr's camchain-imucam or imu.yaml); empty: what the camera file "
       "and the recording say; none: its samples are not read",
       &settings->imu},
      {"motion_guess", kGroup,
       "trajectory (TUM text) with a rough motion between frames, from wheels "
       "or an IMU for example; empty: none",
       &settings->motion_guess},
      {"groundtruth", kGroup,
       "ground-truth trajectory (TUM text); empty: the one in the recording, "
       "if any; none: no comparison",
       &settings->groundtruth},
      {"max_damaged", kGroup,
       "largest share, 0 to 1, of damaged or missing frames, which are "
       "skipped; with "
       "more (at least three) the run stops early and keeps its results",
       &settings->max_damaged},
  };
}

const Trajectory* Sequence::GroundTruth() {
  if (!ground_truth.has_value() && compares) {
    ground_truth = source->ground_truth();
  }
  const bool is_there = ground_truth.has_value() && !ground_truth->empty();
  return is_there ? &*ground_truth : nullptr;
}

std::vector<std::string> DroppedFrames(const FrameSource& source,
                                       const std::vector<std::string>& damaged,
                                       const RepeatedCounts& repeated) {
  constexpr int kMaxNamed = 10;
  const int count = static_cast<int>(damaged.size());
  std::vector<std::string> lines;
  for (int i = 0; i < std::min(count, kMaxNamed); ++i) {
    lines.push_back(damaged[i] + "; this frame is left out");
  }
  for (const auto& [number, what] :
       {std::pair(count - kMaxNamed, " further frames are damaged"),
        {source.unmatched_color(),
         " colour images have no depth image of the same time"},
        {source.dropped(),
         " frames arrived faster than they were processed"}}) {
    if (number <= 0) continue;
    lines.push_back(std::to_string(number) + what + " and are left out");
  }
  for (const auto& [number, image] :
       {std::pair(repeated.color, "colour"), {repeated.depth, "depth"}}) {
    if (number <= 0) continue;
    lines.push_back(std::to_string(number) + " frames repeat the " + image +
                    " image before them under a new time stamp; they are "
                    "degraded");
  }
  for (std::string& line : source.remarks()) lines.push_back(std::move(line));
  return lines;
}

Sequence OpenSequence(const SequenceSettings& settings, bool keep_color,
                      const RgbdCamera* camera) {
  Sequence sequence;
  const SourceOptions options = OptionsOf(settings, keep_color, camera);
  if (options.camera.has_value() && !options.camera->remark.empty()) {
    sequence.remarks.push_back(options.camera->remark);
  }
  sequence.inputs.max_damaged = settings.max_damaged;
  if (!(settings.max_damaged >= 0.0 && settings.max_damaged <= 1.0)) {
    throw InputError("max_damaged must be 0 to 1, a share of the frames");
  }
  const FrameRange range = ParseFrameRange(settings.frames);
  sequence.source = PartOf(OpenSource(settings.source, options), range);
  sequence.inputs.imu = sequence.source->imu();
  if (sequence.inputs.imu.has_value() &&
      !sequence.inputs.imu->calibration.cam_from_imu.has_value()) {
    sequence.remarks.push_back(
        "the mounting of the inertial sensor on the camera is not known "
        "(T_cam_imu), so tracking cannot use it; give it with --imu=FILE");
  }
  sequence.compares = settings.groundtruth != "none";
  if (sequence.compares) {
    FindTruth(settings, &sequence);
    sequence.inputs.truth_noise = FindTruthNoise(settings);
  }
  if (!settings.motion_guess.empty()) {
    Trajectory guess = ReadTrajectory(settings.motion_guess, &sequence.remarks);
    const std::vector<double> times = sequence.source->timestamps();
    if (!times.empty() &&
        (guess.empty() || guess.back().timestamp < times.front() ||
         guess.front().timestamp > times.back())) {
      throw InputError(settings.motion_guess +
                       ": has no pose at the time of the recording");
    }
    sequence.inputs.motion_guess =
        std::make_shared<Trajectory>(std::move(guess));
  }
  return sequence;
}

}  // namespace rgbd_pose
