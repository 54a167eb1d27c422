#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/frame/depth_registration.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_renderer.h"
#include "frontend/sources/dataset.h"

namespace rgbd_pose {

// What to render.
struct SyntheticOptions {
  std::string scene = "room";  // see MakeScene
  std::string path = "xyz";    // see FindSyntheticPath
  int frames = 150;            // how many
  int laps = 1;                // the path is gone so often, see below
  uint32_t seed = 1;           // of textures and noise
  double rate_hz = 30.0;       // frames a second
  bool noise = true;           // of a real sensor, see synthetic_sensor.h
  RgbdCamera camera = {};      // may have distortion

  // How long the shutter is open (s), from half of it before the time of a row
  // to half of it after; at most the time from frame to frame.
  double exposure_s = 0.0;

  // When rows are exposed, from the stamp of each image; the pose of a frame is
  // that of the stamp of colour. Each number is at most the time from frame to
  // frame, and what camera files may hold. Those of `camera` do not count.
  Shutter color_shutter = {};
  Shutter depth_shutter = {};

  // How much later than colour depth is exposed and stamped (s; negative:
  // earlier); less than half the time from frame to frame.
  double depth_delay_s = 0.0;

  // An error of the calibration between both cameras: depth images have a point
  // X (in camera axes, m) where they should have registration_error * X.
  Rigid3d registration_error = {};

  // Takes the depth images, which are not registered to colour then and may
  // have another size: a raw recording. Nothing: they are.
  std::optional<DepthCamera> depth_camera = {};

  // Swing of the automatic exposure, 0..1: see DriftingGain.
  double exposure_drift = 0.0;

  // What moves by itself (see MovingPatch): a patch on this share of the
  // view, 0 to kMaxPatchShare, and boxes, 0 to kMaxWalkingBoxes.
  double moving_patch = 0.0;
  int walking_boxes = 0;

  // Colour sees nothing for so long (s), in the middle of the sequence.
  double black_s = 0.0;

  // How the camera is mounted on what moves along the path, if not straight.
  std::optional<Rigid3d> path_from_cam = {};
};

// The path lasts as long as all frames. With several laps each lasts an equal
// part of that, and they go to and fro in turn, starting and stopping softly:
// at up to pi/2 times the path's own pace.

// An RGB-D sequence rendered as it is read, with exact poses. The same options
// give the same bytes, whatever the order or the number of threads. Time
// stamps start at 1000 s and are whole microseconds, as TUM files hold them.
class SyntheticDataset : public Dataset {
 public:
  // Throws InputError if the options make no sense.
  explicit SyntheticDataset(const SyntheticOptions& options);

  int size() const override { return options_.frames; }
  double timestamp(int index) const override;
  // With its colour and both shutters.
  Frame Read(int index) const override;
  // With the shutters simulated.
  const RgbdCamera& camera() const override { return options_.camera; }

  // The pose at the time stamp.
  Rigid3d WorldFromCam(int index) const;

  // The exact pose of every frame.
  Trajectory ground_truth() const override;

 private:
  // Seconds since the first frame.
  double Time(int index) const { return index / options_.rate_hz; }
  // What a frame with its stamp at time t has: colour as exposed, and depth,
  // exact, as exposed and registered.
  Rendering Render(double t) const;

  SyntheticOptions options_;
  std::function<Rigid3d(double t)> world_from_cam_;
  Renderer renderer_;
  std::optional<Renderer> depth_renderer_;  // if another camera takes depth
};

}  // namespace rgbd_pose
