// Renders a synthetic RGB-D sequence with exact poses to files.

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "apps/shell/stop_signal.h"
#include "core/util/input_error.h"
#include "frontend/files/camera_file.h"
#include "frontend/settings/settings.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_scene.h"
#include "frontend/sources/imu_beside.h"
#include "frontend/sources/tum_writer.h"

namespace rgbd_pose {
namespace {

struct SimulateSettings {
  SyntheticOptions options;
  bool imu = false;
  SyntheticImuOptions imu_options;
  double imu_gyro_bias = 0.0;       // rad/s, of each axis
  double imu_accel_bias = 0.0;      // m/s^2, of each axis
  double registration_shift = 0.0;  // m
  double registration_turn = 0.0;   // degrees
  std::string camera = "ros_default", depth_camera, output;
};

std::vector<Setting> Table(SimulateSettings* settings) {
  constexpr std::string_view kGroup = "Sequence";
  constexpr std::string_view kImu = "Inertial sensor";
  SyntheticImuOptions* imu = &settings->imu_options;
  SyntheticOptions* options = &settings->options;
  return {
      {"scene", kGroup, "scene to render", &options->scene, SceneNames()},
      {"path", kGroup, "camera path", &options->path, SyntheticPathNames()},
      {"frames", kGroup, "number of frames", &options->frames},
      {"rate", kGroup, "frames per second", &options->rate_hz},
      {"laps", kGroup,
       "number of passes along the path within these frames, forward and "
       "backward in turn",
       &options->laps},
      {"seed", kGroup, "seed of textures and noise", &options->seed},
      {"noise", kGroup, "add the noise of a real sensor", &options->noise},
      {"exposure", kGroup, "exposure time (s): blurs motion",
       &options->exposure_s},
      {"exposure_drift", kGroup,
       "swing of the automatic exposure in 4 s, 0..1: gains from exp(-this) to "
       "exp(this)",
       &options->exposure_drift},
      {"moving_patch", kGroup,
       "share of the view, 0..0.45, under a printed sheet 1 m before the "
       "camera that moves through the image at 5 to 8 px per frame",
       &options->moving_patch},
      {"walking_boxes", kGroup,
       "number of boxes, 0..3, that walk to and fro through the scene",
       &options->walking_boxes},
      {"carrier", kGroup,
       "share of the view, 0..0.9 of its height from below, in which the "
       "camera sees what carries it",
       &options->carrier},
      {"black", kGroup,
       "time (s) during which colour is black, in the middle of the sequence",
       &options->black_s},
      {"color_time_offset", kGroup,
       "delay of the exposure of colour, in its middle row, after its time "
       "stamp (s); negative: earlier",
       &options->color_shutter.offset},
      {"color_readout", kGroup,
       "rolling shutter of colour: time from the first row to the last (s); "
       "negative: the last comes first",
       &options->color_shutter.readout},
      {"depth_time_offset", kGroup,
       "delay of the exposure of depth, in its middle row, after its own time "
       "stamp (s); negative: earlier",
       &options->depth_shutter.offset},
      {"depth_readout", kGroup,
       "rolling shutter of depth: time from the first row to the last (s); "
       "negative: the last comes first",
       &options->depth_shutter.readout},
      {"depth_delay", kGroup,
       "delay of depth and its time stamps after colour (s); negative: earlier",
       &options->depth_delay_s},
      {"registration_shift", kGroup,
       "error of the registration of depth: everything is shifted to the right "
       "by this distance (m), along the camera's x axis",
       &settings->registration_shift},
      {"registration_turn", kGroup,
       "error of the registration of depth: everything is turned to the right "
       "by this angle (degrees), around its y axis",
       &settings->registration_turn},
      {"camera", kGroup, "preset or YAML file", &settings->camera,
       CameraPresetNames()},
      {"depth_camera", kGroup,
       "which camera of a Kalibr file (--camera) takes the depth images, which "
       "are not registered to colour then; empty: the same one",
       &settings->depth_camera},
      {"imu", kImu,
       "write the samples of an inertial sensor beside the camera; mounting, "
       "delay and noise are those of the camera file, if it says them",
       &settings->imu},
      {"imu_rate", kImu, "samples per second", &imu->rate_hz},
      {"imu_noise", kImu, "add white noise, and let the biases walk",
       &imu->noise},
      {"imu_gyro_bias", kImu,
       "bias of each axis of the gyroscope at the start (rad/s)",
       &settings->imu_gyro_bias},
      {"imu_accel_bias", kImu,
       "bias of each axis of the accelerometer at the start (m/s^2)",
       &settings->imu_accel_bias},
      {"output", "Output", "folder to create, in TUM RGB-D layout",
       &settings->output},
  };
}

ProgramInfo Info(SimulateSettings* settings) {
  return {"rgbd_simulate",
          "renders a synthetic RGB-D sequence with exact poses to files",
          "rgbd_simulate --path=pan_tilt --frames=150 --output=pan_tilt",
          {},
          {Table(settings)}};
}

// Throws InputError for values that would have no effect, or another one.
void RequireSense(const SimulateSettings& settings) {
  const SimulateSettings usual;
  const SyntheticImuOptions& imu = settings.imu_options;
  if (!settings.imu && (settings.imu_gyro_bias != usual.imu_gyro_bias ||
                        settings.imu_accel_bias != usual.imu_accel_bias ||
                        imu.rate_hz != usual.imu_options.rate_hz ||
                        imu.noise != usual.imu_options.noise)) {
    throw InputError(
        "--imu_rate, --imu_noise, --imu_gyro_bias and --imu_accel_bias need "
        "--imu");
  }
  // The rotation made of it no longer shows how many turns were asked for.
  if (std::abs(settings.registration_turn) > 45.0) {
    throw InputError("--registration_turn must be at most 45 degrees");
  }
}

// The sequence, with its inertial sensor if there shall be one.
std::unique_ptr<FrameSource> Simulate(const SimulateSettings& settings,
                                      const SyntheticOptions& options,
                                      const ImuCalibration& calibration) {
  auto dataset = std::make_unique<SyntheticDataset>(options);
  if (!settings.imu) return dataset;
  SyntheticImuOptions imu = settings.imu_options;
  imu.cam_from_imu = calibration.cam_from_imu.value_or(imu.cam_from_imu);
  imu.delay_s = calibration.delay_s.value_or(imu.delay_s);
  imu.densities = calibration.noise.value_or(imu.densities);
  imu.bias << Eigen::Vector3d::Constant(settings.imu_gyro_bias),
      Eigen::Vector3d::Constant(settings.imu_accel_bias);
  imu.seed = options.seed;
  const std::vector<ImuSample> samples = dataset->SimulateImu(imu);
  return WithImu(std::move(dataset), samples,
                 {{imu.cam_from_imu, imu.delay_s, imu.densities}, true});
}

int Main(const SimulateSettings& settings, const ProgramInfo& info) {
  RequireFlag("output", settings.output);
  RequireSense(settings);
  SyntheticOptions options = settings.options;
  options.registration_error = Rigid3d::FromRotationVector(
      {0.0, settings.registration_turn * M_PI / 180.0, 0.0},
      {settings.registration_shift, 0.0, 0.0});
  const CameraSetup setup =
      ResolveCameraSetup(settings.camera, settings.depth_camera);
  Warn({setup.remark});
  options.camera = RegisteredCamera(setup);
  options.depth_camera = setup.depth_camera;
  const std::unique_ptr<FrameSource> source =
      Simulate(settings, options, setup.imu);
  const StopSignal signal;
  WrittenSequence written;
  {
    ProgressBar bar("rendering", options.frames);
    TumWriterOptions writer;
    writer.threads = AvailableCores();
    writer.truth_noise = {0.0, 0.0, "rendered"};
    writer.progress = [&bar](int done) { bar.Update(done); };
    writer.stop = [&signal] { return signal.name(); };
    written = WriteTumSequence(source.get(), settings.output, writer);
  }
  std::printf("%s: %d frames of path %s in scene %s, with ground truth%s\n",
              settings.output.c_str(), written.frames, options.path.c_str(),
              options.scene.c_str(),
              settings.imu ? " and inertial samples" : "");
  if (written.stopped.empty()) return kExitOk;
  std::fprintf(stderr, "%s: stopped after %d frames (%s); they are in %s\n",
               info.name.c_str(), written.frames, written.stopped.c_str(),
               settings.output.c_str());
  return kExitStopped;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
