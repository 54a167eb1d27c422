#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/frame/depth_registration.h"
#include "frontend/simulation/synthetic_imu.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_renderer.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// The options of a synthetic sequence.
struct SyntheticOptions {
  std::string scene = "room";  // see MakeScene
  std::string path = "xyz";    // see FindSyntheticPath; lasts for all frames
  int frames = 150;            // number of frames
  int laps = 1;                // passes along the path, to and fro in turn
  uint32_t seed = 1;           // of textures and noise
  double rate_hz = 30.0;       // frames per second
  bool noise = true;           // simulate a real sensor, see synthetic_sensor.h
  RgbdCamera camera = {};      // may have distortion

  // Exposure time of a row (s), half of it before and half of it after the time
  // of the row; at most the frame interval.
  double exposure_s = 0.0;

  // When rows are exposed, relative to the stamp of each image; a frame's pose
  // is the one at the colour stamp. At most the frame interval and the limits
  // of camera files. The shutters of `camera` are ignored.
  Shutter color_shutter = {};
  Shutter depth_shutter = {};

  // How much later than colour depth is exposed and stamped (s; negative:
  // earlier); less than half the frame interval.
  double depth_delay_s = 0.0;

  // A calibration error between both cameras: a point that should be at X
  // (camera axes, m) is at registration_error * X in the depth images.
  Rigid3d registration_error = {};

  // The camera of the depth images. They are not registered to colour then and
  // may have another size, as in a raw recording. Nothing: they are registered.
  std::optional<DepthCamera> depth_camera = {};

  // Amplitude of the automatic exposure's gain, 0..1: see DriftingGain.
  double exposure_drift = 0.0;

  // Independently moving objects: a printed sheet over this share of the view,
  // 0 to 0.45, 1 m in front of the camera, that moves on an ellipse at 5 to 8
  // px per frame (640 x 480 at 30 Hz); and 0 to 3 printed boxes that walk to
  // and fro in the scene "room" at up to 0.9 m/s, through its furniture.
  double moving_patch = 0.0;
  int walking_boxes = 0;

  // Share of the view, 0 to 0.9 of its height from below, in which the camera
  // sees what carries it: a printed board that stands still in the image.
  double carrier = 0.0;

  // How long colour is black (s), in the middle of the sequence.
  double black_s = 0.0;

  // The pose of the camera in the axes that follow the path, if not identity.
  std::optional<Rigid3d> path_from_cam = {};
};

// An RGB-D sequence with exact poses, rendered when it is read. The same
// options give the same bytes, in any order and with any number of threads.
// Time stamps start at 1000 s and are whole microseconds, as in TUM files.
class SyntheticDataset : public Dataset {
 public:
  // Throws InputError for invalid options.
  explicit SyntheticDataset(const SyntheticOptions& options);

  int size() const override { return options_.frames; }
  double timestamp(int index) const override;
  // Includes colour and both shutters.
  Frame Read(int index) const override;
  // Includes the simulated shutters.
  const RgbdCamera& camera() const override { return options_.camera; }

  // The pose at the time stamp.
  Rigid3d WorldFromCam(int index) const;

  // The samples of an inertial sensor along the same path, from half a frame
  // interval before the first stamp to half of one after the last. Throws
  // InputError for invalid options and for a delay above 0.4 intervals.
  std::vector<ImuSample> SimulateImu(const SyntheticImuOptions& options) const;

  // The exact pose of every frame.
  Trajectory ground_truth() const override;

 private:
  // Seconds since the first frame.
  double Time(int index) const { return index / options_.rate_hz; }
  // The images of a frame with stamp t: colour as exposed, and exact depth at
  // its own exposure time and registration.
  Rendering Render(double t) const;

  SyntheticOptions options_;
  std::function<Rigid3d(double t)> world_from_cam_;
  Renderer renderer_;
  std::optional<Renderer> depth_renderer_;  // if another camera takes depth
};

}  // namespace rgbd_pose
