#include "frontend/simulation/synthetic_dataset.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_sensor.h"

namespace rgbd_pose {
namespace {

void CheckShutters(const RgbdCamera& camera, double frame_s) {
  for (const ShutterParameter& parameter : kShutterParameters) {
    const double size = std::abs(camera.*parameter.image.*parameter.value);
    const double most = std::min(frame_s, parameter.most);
    if (!(size <= most)) {
      throw InputError(
          Format("%s of a synthetic sequence must be at most %.6g s in "
                 "magnitude, %s",
                 parameter.name, most,
                 frame_s <= parameter.most ? "the time from frame to frame"
                                           : "as in camera files"));
    }
  }
}

// Whether every pixel has a ray: the distortion is worst in the corners.
bool SeesEverywhere(const Camera& camera) {
  for (const double u : {0.0, camera.width - 1.0}) {
    for (const double v : {0.0, camera.height - 1.0}) {
      if (!camera.Undistort({u, v}).allFinite()) return false;
    }
  }
  return true;
}

// Checks the options and stores the shutters in the camera as well.
SyntheticOptions Checked(SyntheticOptions options) {
  constexpr int kMaxFrames = 1000000;  // 9 hours at 30 Hz
  const auto require = [](bool holds, const std::string& problem) {
    if (!holds) throw InputError(problem);
  };
  options.color_shutter.is_known = true;
  options.camera.color_shutter = options.color_shutter;
  options.camera.depth_shutter = options.depth_shutter;
  require(options.frames >= 1 && options.frames <= kMaxFrames,
          "a synthetic sequence has 1 to " + std::to_string(kMaxFrames) +
              " frames, not " + std::to_string(options.frames));
  require(options.laps >= 1, "a synthetic sequence has 1 or more laps, not " +
                                 std::to_string(options.laps));
  // Time stamps are whole microseconds and must differ.
  require(options.rate_hz > 0.0 && options.rate_hz <= 1e5,
          "the rate of a synthetic sequence must be in 0..1e5 Hz");
  require(options.camera.depth_scale > 0.0,
          "depth_scale of a synthetic sequence must be positive");
  RequireSound(options.camera.camera.Check(),
               "camera of the synthetic sequence: ");
  require(SeesEverywhere(options.camera.camera),
          "camera of the synthetic sequence: its distortion cannot be inverted "
          "in the corners of the image");
  const double frame_s = 1.0 / options.rate_hz;
  require(options.exposure_s >= 0.0 && options.exposure_s <= frame_s,
          "the shutter time of a synthetic sequence must be in 0.." +
              std::to_string(frame_s) + " s, the time from frame to frame");
  CheckShutters(options.camera, frame_s);
  require(std::abs(options.depth_delay_s) < 0.5 / options.rate_hz,
          "the depth delay of a synthetic sequence must be below " +
              std::to_string(0.5 / options.rate_hz) +
              " s, half the time from frame to frame");
  require(
      options.registration_error.Angle() < M_PI / 4 &&
          options.registration_error.translation.norm() < 1.0,
      "the registration error of a synthetic sequence must be below 1 m and "
      "45 degrees");
  if (options.depth_camera.has_value()) {
    RequireSound(options.depth_camera->camera.Check(), "depth camera: ");
    require(SeesEverywhere(options.depth_camera->camera),
            "depth camera: its distortion cannot be inverted in the corners");
  }
  require(options.exposure_drift >= 0.0 && options.exposure_drift <= 1.0,
          "exposure_drift of a synthetic sequence must be in 0..1");
  require(options.moving_patch >= 0.0 && options.moving_patch <= kMaxPatchShare,
          "moving_patch of a synthetic sequence must be in 0.." +
              Format("%g", kMaxPatchShare));
  require(
      options.walking_boxes >= 0 && options.walking_boxes <= kMaxWalkingBoxes,
      "a synthetic sequence has 0 to " + std::to_string(kMaxWalkingBoxes) +
          " walking boxes");
  require(options.black_s >= 0.0,
          "the black time of a synthetic sequence must be 0 s or more");
  return options;
}

// world_from_cam, t seconds after the first frame.
std::function<Rigid3d(double t)> CameraPath(const SyntheticOptions& options) {
  const SyntheticPath path = FindSyntheticPath(options.path);
  const double lap = (options.frames - 1) / options.rate_hz / options.laps;
  return [path, lap, laps = options.laps,
          path_from_cam = options.path_from_cam](double t) {
    const double on_path = laps == 1 || lap == 0.0
                               ? t
                               : lap * 0.5 * (1.0 - std::cos(M_PI * t / lap));
    const Rigid3d world_from_path = path(on_path, lap);
    return path_from_cam.has_value() ? world_from_path * *path_from_cam
                                     : world_from_path;
  };
}

Renderer MakeRenderer(const SyntheticOptions& options, const Camera& camera,
                      const std::function<Rigid3d(double t)>& path) {
  std::vector<SyntheticMover> movers =
      WalkingBoxes(options.walking_boxes, options.seed);
  if (options.moving_patch > 0.0) {
    movers.push_back(MovingPatch(options.moving_patch, options.camera.camera,
                                 path, options.seed));
  }
  return Renderer(MakeScene(options.scene, options.seed), camera, movers);
}

}  // namespace

SyntheticDataset::SyntheticDataset(const SyntheticOptions& options)
    : options_(Checked(options)),
      world_from_cam_(CameraPath(options_)),
      renderer_(
          MakeRenderer(options_, options_.camera.camera, world_from_cam_)) {
  if (options_.depth_camera.has_value()) {
    depth_renderer_ =
        MakeRenderer(options_, options_.depth_camera->camera, world_from_cam_);
  }
}

double SyntheticDataset::timestamp(int index) const {
  constexpr double kFirstStamp = 1000.0;  // s
  return std::round((kFirstStamp + Time(index)) * 1e6) / 1e6;
}

Rigid3d SyntheticDataset::WorldFromCam(int index) const {
  return world_from_cam_(Time(index));
}

// With the registration error E, depth is rendered from world_from_cam * E^-1:
// a point X of the camera axes is at E * X there.
Rendering SyntheticDataset::Render(double t) const {
  const double focal_px = options_.camera.camera.fx;
  const Shutter& color = options_.color_shutter;
  const Shutter& depth = options_.depth_shutter;
  const double color_time = t + color.offset;
  const double depth_time = t + (options_.depth_delay_s + depth.offset);
  Rendering seen = Expose(
      renderer_, focal_px, world_from_cam_, color_time,
      {options_.exposure_s, DriftingGain(options_.exposure_drift, color_time),
       color.readout});
  Rigid3d cam_from_depth = options_.registration_error.Inverse();
  if (depth_renderer_.has_value()) {
    cam_from_depth = cam_from_depth * options_.depth_camera->color_from_depth;
  }
  if (depth_renderer_.has_value() || depth_time != color_time ||
      depth.readout != color.readout || !cam_from_depth.IsIdentity()) {
    seen.depth =
        Expose(
            depth_renderer_.has_value() ? *depth_renderer_ : renderer_,
            focal_px,
            [&](double time) { return world_from_cam_(time) * cam_from_depth; },
            depth_time, {0.0, 1.0, depth.readout})
            .depth;
  }
  return seen;
}

Frame SyntheticDataset::Read(int index) const {
  const double t = Time(index);
  Rendering rendering = Render(t);
  const double from_middle = t - Time(options_.frames - 1) / 2.0;
  if (std::abs(from_middle) < options_.black_s / 2.0) {
    rendering.color.setTo(0);
  }
  if (options_.noise) {
    // One key per image. An image uses fewer than 2^40 numbers from its key on.
    const uint64_t sequence = HashCounter(options_.seed);
    const uint64_t frame = static_cast<uint64_t>(index) << 41;
    AddColorNoise(sequence + frame, &rendering.color);
    const Camera& measures = depth_renderer_.has_value()
                                 ? options_.depth_camera->camera
                                 : options_.camera.camera;
    rendering.depth = MeasureDepth(rendering.depth, measures.fx,
                                   sequence + frame + (uint64_t{1} << 40));
  }
  Frame frame;
  frame.index = index;
  frame.timestamp = timestamp(index);
  frame.depth_delay = options_.depth_delay_s;
  frame.color_shutter = options_.color_shutter;
  frame.depth_shutter = options_.depth_shutter;
  frame.color = rendering.color;
  cv::cvtColor(frame.color, frame.gray, cv::COLOR_BGR2GRAY);
  frame.depth_scale = options_.camera.depth_scale;
  frame.depth = EncodeDepth(rendering.depth, frame.depth_scale);
  return frame;
}

Trajectory SyntheticDataset::ground_truth() const {
  Trajectory trajectory(size());
  for (int i = 0; i < size(); ++i) {
    trajectory[i] = {timestamp(i), WorldFromCam(i)};
  }
  return trajectory;
}

}  // namespace rgbd_pose
