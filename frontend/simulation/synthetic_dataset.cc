#include "frontend/simulation/synthetic_dataset.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_sensor.h"

namespace rgbd_pose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kFirstStamp = 1000.0;  // s

using Path = std::function<Rigid3d(double t)>;  // world_from_cam

constexpr double kMaxPatchShare = 0.45;  // a larger one would leave the image

// A printed sheet that moves with the camera, perpendicular to its optical axis
// and with the image's aspect ratio.
SyntheticMover MovingPatch(const SyntheticOptions& options, const Path& path) {
  constexpr double kDepth = 1.0;  // m
  // Semi-axes of the ellipse, as shares of the image, and its angular rate
  // (rad/s): 150 to 240 px/s.
  constexpr double kHalfWidth = 100.0 / 640.0;
  constexpr double kHalfHeight = 62.5 / 480.0;
  constexpr double kRate = 2.4;
  const Camera& camera = options.camera.camera;
  const double share = options.moving_patch;
  const double width = kDepth * camera.width / camera.fx;  // of the view, m
  const double height = kDepth * camera.height / camera.fy;
  SyntheticMover patch;
  SceneFace face;
  face.width = std::sqrt(share) * width;
  face.height = std::sqrt(share) * height;
  face.origin = {-face.width / 2, -face.height / 2, kDepth};
  face.normal = -Vector3d::UnitZ();
  face.material = kPoster;
  face.seed = HashCell(1, 2, options.seed);
  patch.scene = {{face}, {0.3, -0.3, -1.5}};
  patch.world_from_mover = [path, width, height](double t) {
    return path(t) * Rigid3d(Quaterniond::Identity(),
                             {kHalfWidth * width * std::cos(kRate * t),
                              kHalfHeight * height * std::sin(kRate * t), 0.0});
  };
  return patch;
}

// A part of whatever carries the camera: a printed board across the lower part
// of the view, which stands still in the image.
SyntheticMover Carrier(const SyntheticOptions& options, const Path& path) {
  constexpr double kDepth = 0.8;  // m
  const Camera& camera = options.camera.camera;
  SceneFace face;
  face.width = kDepth * camera.width / camera.fx;
  face.height = options.carrier * kDepth * camera.height / camera.fy;
  face.origin = {
      -kDepth * (camera.cx + 0.5) / camera.fx,
      kDepth * (camera.height - 0.5 - camera.cy) / camera.fy - face.height,
      kDepth};
  face.normal = -Vector3d::UnitZ();
  face.material = kPoster;
  face.seed = HashCell(1, 4, options.seed);
  SyntheticMover carrier;
  carrier.scene = {{face}, {0.3, -0.3, -1.5}};
  carrier.world_from_mover = path;
  return carrier;
}

struct WalkingBox {
  SceneBox box;   // in the middle of its way
  Vector3d half;  // from there to either end (m)
  double rate;    // of its phase (rad/s)
  double phase;   // at time 0 (rad)
};

// In front of the desk, behind it, and towards and away from the camera.
const WalkingBox kWalkingBoxes[] = {
    {{{-0.05, 0.0, 0.0}, {0.30, 0.40, 1.25}, 10}, {0.0, 1.1, 0.0}, 0.8, 4.0},
    {{{1.50, 0.1, 0.0}, {0.40, 0.50, 1.50}, -20}, {0.0, 1.2, 0.0}, 0.7, 0.5},
    {{{0.90, -0.8, 0.0}, {0.35, 0.45, 1.40}, 25}, {0.9, 0.2, 0.0}, 0.9, 2.2}};

constexpr int kMaxWalkingBoxes = std::size(kWalkingBoxes);

SyntheticMover MakeWalkingBox(int i, uint32_t seed) {
  const WalkingBox& walking = kWalkingBoxes[i];
  SyntheticMover box;
  box.scene = {{}, {-1.0, 0.3, 2.2}, HashCell(i, 3, seed)};
  AddBox({Vector3d::Zero(), walking.box.size, walking.box.yaw_deg}, kPoster,
         &box.scene);
  box.world_from_mover = [&walking](double t) {
    const double swing = std::sin(walking.rate * t + walking.phase);
    return Rigid3d(Quaterniond::Identity(),
                   walking.box.foot + swing * walking.half);
  };
  return box;
}

void Require(bool holds, const std::string& problem) {
  if (!holds) throw InputError(problem);
}

void CheckShutters(const RgbdCamera& camera, double frame_s) {
  for (const ShutterParameter& parameter : kShutterParameters) {
    const double size = std::abs(camera.*parameter.image.*parameter.value);
    const double most = std::min(frame_s, parameter.most);
    Require(size <= most,
            Format("%s of a synthetic sequence must be at most %.6g s in "
                   "magnitude, %s",
                   parameter.name, most,
                   frame_s <= parameter.most ? "the time from frame to frame"
                                             : "as in camera files"));
  }
}

void CheckCamera(const Camera& camera, const std::string& name) {
  RequireSound(camera.Check(), name + ": ");
  // Every pixel must have a ray: the distortion is worst in the corners.
  for (const double u : {0.0, camera.width - 1.0}) {
    for (const double v : {0.0, camera.height - 1.0}) {
      Require(camera.Undistort({u, v}).allFinite(),
              name +
                  ": its distortion cannot be inverted in the corners of "
                  "the image");
    }
  }
}

// Checks the options and stores the shutters in the camera as well. The noise
// is that of the simulation.
SyntheticOptions Checked(SyntheticOptions options) {
  constexpr int kMaxFrames = 1000000;  // 9 hours at 30 Hz
  options.color_shutter.is_known = true;
  options.camera.color_shutter = options.color_shutter;
  options.camera.depth_shutter = options.depth_shutter;
  options.camera.depth_noise.reset();
  Require(options.frames >= 1 && options.frames <= kMaxFrames,
          Format("a synthetic sequence has 1 to %d frames, not %d", kMaxFrames,
                 options.frames));
  Require(
      options.laps >= 1,
      Format("a synthetic sequence has 1 or more laps, not %d", options.laps));
  // Time stamps are whole microseconds and must differ.
  Require(options.rate_hz > 0.0 && options.rate_hz <= 1e5,
          "the rate of a synthetic sequence must be in 0..1e5 Hz");
  Require(options.camera.depth_scale > 0.0,
          "depth_scale of a synthetic sequence must be positive");
  CheckCamera(options.camera.camera, "camera of the synthetic sequence");
  const double frame_s = 1.0 / options.rate_hz;
  Require(options.exposure_s >= 0.0 && options.exposure_s <= frame_s,
          Format("the shutter time of a synthetic sequence must be in 0..%f s, "
                 "the time from frame to frame",
                 frame_s));
  CheckShutters(options.camera, frame_s);
  Require(std::abs(options.depth_delay_s) < 0.5 / options.rate_hz,
          Format("the depth delay of a synthetic sequence must be below %f s, "
                 "half the time from frame to frame",
                 0.5 / options.rate_hz));
  Require(options.registration_error.Angle() < M_PI / 4 &&
              options.registration_error.translation.norm() < 1.0,
          "the registration error of a synthetic sequence must be below 1 m "
          "and 45 degrees");
  if (options.depth_camera.has_value()) {
    CheckCamera(options.depth_camera->camera, "depth camera");
  }
  Require(options.exposure_drift >= 0.0 && options.exposure_drift <= 1.0,
          "exposure_drift of a synthetic sequence must be in 0..1");
  Require(options.carrier >= 0.0 && options.carrier <= 0.9,
          "carrier of a synthetic sequence must be in 0..0.9");
  Require(options.moving_patch >= 0.0 && options.moving_patch <= kMaxPatchShare,
          Format("moving_patch of a synthetic sequence must be in 0..%g",
                 kMaxPatchShare));
  Require(
      options.walking_boxes >= 0 && options.walking_boxes <= kMaxWalkingBoxes,
      Format("a synthetic sequence has 0 to %d walking boxes",
             kMaxWalkingBoxes));
  Require(options.black_s >= 0.0,
          "the black time of a synthetic sequence must be 0 s or more");
  return options;
}

// Laps share the time equally. Several start and stop smoothly, at up to pi/2
// times the path's own speed.
Path CameraPath(const SyntheticOptions& options) {
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
                      const Path& path) {
  std::vector<SyntheticMover> movers;
  for (int i = 0; i < options.walking_boxes; ++i) {
    movers.push_back(MakeWalkingBox(i, options.seed));
  }
  if (options.moving_patch > 0.0) movers.push_back(MovingPatch(options, path));
  if (options.carrier > 0.0) movers.push_back(Carrier(options, path));
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

std::vector<ImuSample> SyntheticDataset::SimulateImu(
    const SyntheticImuOptions& options) const {
  // The path is defined up to an interval outside of its frames.
  const double interval = 1.0 / options_.rate_hz;
  if (std::abs(options.delay_s) > 0.4 * interval) {
    throw InputError(Format(
        "delay_s of the inertial sensor is %g s, at most 0.4 of the frame "
        "interval of %g s are possible",
        options.delay_s, interval));
  }
  std::vector<ImuSample> samples =
      rgbd_pose::SimulateImu(world_from_cam_, -0.5 * interval,
                             Time(size() - 1) + 0.5 * interval, options);
  for (ImuSample& sample : samples) sample.stamp += kFirstStamp;
  return samples;
}

double SyntheticDataset::timestamp(int index) const {
  return std::round((kFirstStamp + Time(index)) * 1e6) / 1e6;
}

Rigid3d SyntheticDataset::WorldFromCam(int index) const {
  return world_from_cam_(Time(index));
}

// With the registration error E, depth is rendered from world_from_cam * E^-1:
// a point X of the camera axes is at E * X there.
Rendering SyntheticDataset::Render(double t) const {
  const Shutter& color = options_.color_shutter;
  const Shutter& depth = options_.depth_shutter;
  const double color_time = t + color.offset;
  const double depth_time = t + (options_.depth_delay_s + depth.offset);
  Rendering seen = Expose(
      renderer_, options_.camera.camera.fx, world_from_cam_, color_time,
      {options_.exposure_s, DriftingGain(options_.exposure_drift, color_time),
       color.readout});
  Rigid3d cam_from_depth = options_.registration_error.Inverse();
  if (depth_renderer_.has_value()) {
    cam_from_depth = cam_from_depth * options_.depth_camera->color_from_depth;
  }
  if (depth_renderer_.has_value() || depth_time != color_time ||
      depth.readout != color.readout || !cam_from_depth.IsIdentity()) {
    const Renderer& renderer =
        depth_renderer_.has_value() ? *depth_renderer_ : renderer_;
    const auto path = [&](double time) {
      return world_from_cam_(time) * cam_from_depth;
    };
    seen.depth = renderer.Render(path, depth_time, depth.readout).depth;
  }
  return seen;
}

Frame SyntheticDataset::Read(int index) const {
  const double t = Time(index);
  Rendering rendering = Render(t);
  const double from_middle = t - Time(options_.frames - 1) / 2.0;
  if (std::abs(from_middle) < options_.black_s / 2.0) rendering.color.setTo(0);
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
  Frame frame = {index, timestamp(index), options_.depth_delay_s};
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
