// Renders a synthetic RGB-D sequence with exact poses to files.

#include <gflags/gflags.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "frontend/files/camera_file.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_scene.h"
#include "frontend/sources/tum_writer.h"

DEFINE_string(scene, "room", "what to look at");
DEFINE_string(path, "xyz", "how to move");
DEFINE_int32(frames, 150, "number of frames");
DEFINE_double(rate, 30.0, "frames a second");
DEFINE_int32(laps, 1,
             "how often the path is gone within these frames, to and fro in "
             "turn");
DEFINE_uint32(seed, 1, "seed of textures and noise");
DEFINE_bool(noise, true, "add the noise of a real sensor");
DEFINE_double(exposure, 0.0, "how long the shutter is open (s): blurs motion");
DEFINE_double(exposure_drift, 0.0,
              "swing of the automatic exposure in 4 s, 0..1: gains from "
              "exp(-this) to exp(this)");
DEFINE_double(
    moving_patch, 0.0,
    "share of the view, 0..0.45, under a printed sheet 1 m before the "
    "camera that moves through the image at 5 to 8 px a frame");
DEFINE_int32(walking_boxes, 0,
             "how many boxes, 0..3, walk to and fro through the scene 'room'");
DEFINE_double(black, 0.0,
              "colour is black for so long (s), in the middle of the sequence");
DEFINE_double(color_time_offset, 0.0,
              "how much later than its stamp says colour is exposed, in its "
              "middle row (s); negative: earlier");
DEFINE_double(color_readout, 0.0,
              "rolling shutter of colour: time from the first row to the last "
              "(s); negative: the last comes first");
DEFINE_double(depth_time_offset, 0.0,
              "how much later than its own stamp says depth is exposed, in its "
              "middle row (s); negative: earlier");
DEFINE_double(depth_readout, 0.0,
              "rolling shutter of depth: time from the first row to the last "
              "(s); negative: the last comes first");
DEFINE_double(depth_delay, 0.0,
              "how much later depth is exposed and stamped (s); negative: "
              "earlier");
DEFINE_double(registration_shift, 0.0,
              "error of the registration of depth: everything is so far (m) to "
              "the right, along the camera's x axis");
DEFINE_double(registration_turn, 0.0,
              "error of the registration of depth: everything is turned so far "
              "(degrees) to the right, around its y axis");
DEFINE_string(camera, "ros_default", "preset or YAML file");
DEFINE_string(
    depth_camera, "",
    "which camera of a Kalibr file (--camera) takes the depth images, "
    "which are not registered to colour then; empty: the same one");
DEFINE_string(output, "", "folder to create, in TUM RGB-D layout");

namespace rgbd_pose {
namespace {

int Simulate() {
  RequireFlag("output", FLAGS_output);
  SyntheticOptions options;
  options.scene = FLAGS_scene;
  options.path = FLAGS_path;
  options.frames = FLAGS_frames;
  options.rate_hz = FLAGS_rate;
  options.laps = FLAGS_laps;
  options.seed = FLAGS_seed;
  options.noise = FLAGS_noise;
  options.exposure_s = FLAGS_exposure;
  options.exposure_drift = FLAGS_exposure_drift;
  options.moving_patch = FLAGS_moving_patch;
  options.walking_boxes = FLAGS_walking_boxes;
  options.black_s = FLAGS_black;
  options.color_shutter = {FLAGS_color_time_offset, FLAGS_color_readout};
  options.depth_shutter = {FLAGS_depth_time_offset, FLAGS_depth_readout};
  options.depth_delay_s = FLAGS_depth_delay;
  options.registration_error = Rigid3d(
      Eigen::Quaterniond(Eigen::AngleAxisd(
          FLAGS_registration_turn * M_PI / 180.0, Eigen::Vector3d::UnitY())),
      {FLAGS_registration_shift, 0.0, 0.0});
  const CameraSetup setup =
      ResolveCameraSetup(FLAGS_camera, FLAGS_depth_camera);
  options.camera = RegisteredCamera(setup);
  options.depth_camera = setup.depth_camera;
  SyntheticDataset dataset(options);
  {
    ProgressBar bar("rendering", dataset.size());
    TumWriterOptions writer;
    writer.threads = AvailableCores();
    writer.progress = [&bar](int done) { bar.Update(done); };
    WriteTumSequence(&dataset, FLAGS_output, writer);
  }
  std::printf("%s: %d frames of path %s in scene %s, with ground truth\n",
              FLAGS_output.c_str(), dataset.size(), FLAGS_path.c_str(),
              FLAGS_scene.c_str());
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  const rgbd_pose::ProgramInfo info = {
      "rgbd_simulate",
      "renders a synthetic RGB-D sequence with exact poses to files",
      "rgbd_simulate --path=pan_tilt --frames=150 --output=pan_tilt",
      {{"Sequence",
        {"scene",
         "path",
         "frames",
         "rate",
         "laps",
         "seed",
         "noise",
         "exposure",
         "exposure_drift",
         "moving_patch",
         "walking_boxes",
         "black",
         "color_time_offset",
         "color_readout",
         "depth_time_offset",
         "depth_readout",
         "depth_delay",
         "registration_shift",
         "registration_turn",
         "camera",
         "depth_camera"}},
       {"Output", {"output"}}},
      {{"scene", rgbd_pose::SceneNames()},
       {"path", rgbd_pose::SyntheticPathNames()},
       {"camera", rgbd_pose::CameraPresetNames()}}};
  return rgbd_pose::RunProgram(argc, argv, info, rgbd_pose::Simulate);
}
