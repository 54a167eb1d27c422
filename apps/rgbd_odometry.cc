// Camera motion of an RGB-D sequence: dataset in; trajectory, figures and
// errors out.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>

#include "apps/pipeline/odometry_run.h"
#include "apps/report/report_page.h"
#include "apps/results/run_output.h"
#include "apps/shell/available_cores.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "apps/shell/setting_flags.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "frontend/image/depth_scale.h"
#include "frontend/sources/camera_file.h"
#include "frontend/sources/tum_dataset.h"

DEFINE_string(dataset, "", "folder of a sequence in TUM RGB-D layout");
DEFINE_string(associations, "",
              "file that pairs colour and depth images, either column order; "
              "empty: rgb.txt and depth.txt are paired by time");
DEFINE_string(camera, "",
              "YAML file (ORB-SLAM2/3, ROS camera_info or Kalibr layout) or "
              "preset");
DEFINE_double(depth_scale, 0.0,
              "raw depth units per metre; 0: as the camera says");
DEFINE_string(motion_guess, "",
              "trajectory (TUM text) that tells roughly how the camera moved "
              "between frames: wheels, an inertial sensor; empty: none");
DEFINE_int32(threads, 0,
             "threads that read images ahead and track; 0: one a core; the "
             "result does not depend on it");
DEFINE_string(groundtruth, "",
              "trajectory to compare with (TUM text); empty: groundtruth.txt "
              "of the dataset if it is there");
DEFINE_bool(validate_only, false,
            "only read every image and say how fast that goes; needs no "
            "--output");
DEFINE_string(debug_images, "",
              "frames whose matches are drawn into OUTPUT/debug, coloured by "
              "robust weight: all, or numbers and ranges such as 10,20-40:5");
DEFINE_string(save_cloud, "",
              "file for a coloured point cloud of what was seen (PLY), in the "
              "world of the trajectory; empty: none");
DEFINE_double(voxel, 0.01,
              "side of the cubes (m) that the cloud's points are merged in");
DEFINE_bool(report, true, "write OUTPUT/report.html, to look at in a browser");
DEFINE_string(output, "", "folder for the results, made if missing");

namespace rgbd_pose {
namespace {

OdometrySettings& Settings() {
  static OdometrySettings settings;
  return settings;
}

const SettingFlags& Flags() {
  static const SettingFlags flags(SettingTable(&Settings()));
  return flags;
}

ProgramInfo Info() {
  ProgramInfo info;
  info.name = "rgbd_odometry";
  info.summary = "estimates the motion of an RGB-D camera along a sequence.";
  info.example =
      "rgbd_odometry --dataset=rgbd_dataset_freiburg1_xyz --camera=tum_fr1 "
      "--output=runs/fr1_xyz";
  info.flag_groups = {{"Input",
                       {"dataset", "associations", "camera", "depth_scale",
                        "motion_guess", "groundtruth", "validate_only"}}};
  info.choices = {{"camera", CameraPresetNames()}};
  Flags().Describe(&info);
  info.flag_groups.push_back(
      {"Output",
       {"output", "report", "debug_images", "save_cloud", "voxel", "threads"}});
  return info;
}

// A run that tracked less of its frames than this has failed.
constexpr double kMinTrackedShare = 0.5;

// More than any machine can use for this.
constexpr int kMaxThreads = 256;

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int NumThreads() {
  if (FLAGS_threads < 0 || FLAGS_threads > kMaxThreads) {
    throw InputError("--threads must be 0 (one a core) to " +
                     std::to_string(kMaxThreads));
  }
  if (FLAGS_threads > 0) return FLAGS_threads;
  return std::min(AvailableCores(), kMaxThreads);
}

TumDataset OpenDataset() {
  TumDatasetOptions options;
  options.folder = FLAGS_dataset;
  options.associations_file = FLAGS_associations;
  options.camera = ResolveCamera(FLAGS_camera);
  if (!(FLAGS_depth_scale >= 0.0)) {
    throw InputError("--depth_scale must be positive (raw units per metre)");
  }
  if (FLAGS_depth_scale > 0.0) options.camera.depth_scale = FLAGS_depth_scale;
  return TumDataset(options);
}

std::optional<Trajectory> FindGroundTruth() {
  if (!FLAGS_groundtruth.empty()) return ReadTrajectory(FLAGS_groundtruth);
  const std::filesystem::path path =
      std::filesystem::path(FLAGS_dataset) / "groundtruth.txt";
  if (!std::filesystem::exists(path)) return std::nullopt;
  return ReadTrajectory(path.string());
}

// A help to look at a run; a program built without the library that it needs
// says so and goes on.
std::string WriteReport(const std::filesystem::path& folder) {
  if (!FLAGS_report) return "";
  if (!HasReportLibrary()) {
    return std::string("report in   ") + kNoReportLibrary + "\n";
  }
  WriteRunReport(folder.string());
  return "report in   " + FLAGS_output + "/report.html\n";
}

int ValidateOnly(TumDataset* dataset, int threads) {
  const Clock::time_point start = Clock::now();
  std::vector<double> decode_ms;
  {
    ProgressBar bar("reading", dataset->size());
    FrameStream stream(dataset, nullptr, threads);
    while (const auto next = stream.Next()) {
      decode_ms.push_back(next->decode_ms);
      bar.Update(static_cast<int>(decode_ms.size()));
    }
  }
  std::printf("frames      %d, all readable\n", dataset->size());
  std::printf(
      "decoding    %.1f frames/s with %d thread(s), %.2f ms per frame median\n",
      dataset->size() / SecondsSince(start), threads, Median(decode_ms));
  return kExitOk;
}

int Main() {
  const Clock::time_point start = Clock::now();
  RequireFlag("dataset", FLAGS_dataset);
  RequireFlag("camera", FLAGS_camera);
  if (!FLAGS_validate_only) RequireFlag("output", FLAGS_output);
  const int threads = NumThreads();
  // The threads are ours: OpenCV's own would only compete with them.
  cv::setNumThreads(1);

  // All that can be wrong with the input is looked at before the work starts
  // and before anything is written.
  TumDataset dataset = OpenDataset();
  const Camera& camera = dataset.camera().camera;
  if (FLAGS_validate_only) return ValidateOnly(&dataset, threads);
  Flags().Apply();
  const std::optional<Trajectory> truth = FindGroundTruth();
  if (truth.has_value()) RequireOverlap(dataset, *truth);
  std::optional<MotionGuess> motion_guess;
  if (!FLAGS_motion_guess.empty()) {
    motion_guess.emplace(ReadTrajectory(FLAGS_motion_guess));
  }
  OdometryRun run(Settings(), camera,
                  {motion_guess.has_value() ? &*motion_guess : nullptr,
                   truth.has_value() ? &*truth : nullptr});
  const std::string warning = DepthScaleWarning(dataset.Read(0));
  RunOutput output({FLAGS_dataset, FLAGS_output, FLAGS_debug_images,
                    FLAGS_save_cloud, FLAGS_voxel},
                   dataset);
  if (!warning.empty()) LOG(WARNING) << warning;
  if (dataset.unmatched_color() > 0) {
    LOG(WARNING) << dataset.unmatched_color()
                 << " colour images have no depth image within 0.02 s and "
                    "are left out";
  }

  {
    ProgressBar bar("tracking", dataset.size());
    TrackAll(&dataset, threads, {&run}, [&](const Frame& frame) {
      output.Add(frame, run);
      bar.Update(frame.index + 1);
    });
  }
  const double seconds = SecondsSince(start);

  const RunResults results = std::move(run).Finish();
  if (!results.no_evaluation.empty()) {
    LOG(WARNING) << "no errors: " << results.no_evaluation;
  }
  std::string text =
      output.Write(results, Summarise(results.frames, threads, seconds),
                   truth.has_value() ? &*truth : nullptr,
                   FormatFlagFile(Info()));
  text += WriteReport(output.aside());
  output.Publish();
  std::printf("%sresults in  %s\n", text.c_str(), FLAGS_output.c_str());
  if (results.TrackedShare() >= kMinTrackedShare) return kExitOk;
  std::fprintf(stderr,
               "rgbd_odometry: only %.1f %% of the frames were tracked; "
               "%s/frames.csv says why\n",
               100.0 * results.TrackedShare(), FLAGS_output.c_str());
  return kExitTrackingFailed;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
