// Camera motion of an RGB-D sequence: dataset in; trajectory, figures and
// errors out.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>

#include "apps/pipeline/odometry_run.h"
#include "apps/report/report_page.h"
#include "apps/results/cloud_preview.h"
#include "apps/results/evaluation_report.h"
#include "apps/results/frame_errors.h"
#include "apps/results/residual_histogram.h"
#include "apps/results/run_folder.h"
#include "apps/results/run_summary.h"
#include "apps/shell/available_cores.h"
#include "apps/shell/frame_selection.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/pose_pairs.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/depth_noise.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "core/util/text_file.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/features/match_overlay.h"
#include "frontend/image/depth_scale.h"
#include "frontend/map/cloud_fusion.h"
#include "frontend/map/ply_writer.h"
#include "frontend/sources/camera_file.h"
#include "frontend/sources/image_file.h"
#include "frontend/sources/tum_dataset.h"
#include "robust/m_estimator.h"
#include "robust/scale.h"

DEFINE_string(dataset, "", "folder of a sequence in TUM RGB-D layout");
DEFINE_string(associations, "",
              "file that pairs colour and depth images, either column order; "
              "empty: rgb.txt and depth.txt are paired by time");
DEFINE_string(camera, "",
              "YAML file (ORB-SLAM2/3, ROS camera_info or Kalibr layout) or "
              "preset");
DEFINE_double(depth_scale, 0.0,
              "raw depth units per metre; 0: as the camera says");
DEFINE_string(depth_noise, "khoshelham", "depth noise model");
DEFINE_string(cost, "bidirectional_point",
              "cost of a match; several added up: a+b");
DEFINE_string(loss, "tukey", "M-estimator; one for each of several costs: a,b");
DEFINE_string(assembly, "compressed",
              "how matches become Ceres residual blocks");
DEFINE_string(scale, "fixed",
              "spread of the residuals: as the noise model says or estimated");
DEFINE_string(robust_schedule, "gnc",
              "losses at their widths at once, or wide at first and narrowed "
              "step by step");
DEFINE_string(initial_guess, "last", "where the solver starts in a frame");
DEFINE_string(on_lost, "new_segment",
              "what to do with frames whose motion is not found; they are "
              "searched for among earlier references in any case but stop");
DEFINE_string(motion_guess, "",
              "trajectory (TUM text) that tells roughly how the camera moved "
              "between frames: wheels, an inertial sensor; empty: none");
DEFINE_string(frontend, "patch", "where matches come from");
DEFINE_int32(max_features, 600, "features wanted in a reference frame");
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

ProgramInfo Info() {
  ProgramInfo info;
  info.name = "rgbd_odometry";
  info.summary = "estimates the motion of an RGB-D camera along a sequence.";
  info.example =
      "rgbd_odometry --dataset=rgbd_dataset_freiburg1_xyz --camera=tum_fr1 "
      "--output=runs/fr1_xyz";
  info.flag_groups = {
      {"Input",
       {"dataset", "associations", "camera", "depth_scale", "depth_noise",
        "motion_guess", "groundtruth", "validate_only"}},
      {"Estimation",
       {"cost", "loss", "scale", "robust_schedule", "initial_guess", "on_lost",
        "assembly", "frontend", "max_features", "threads"}},
      {"Output", {"output", "report", "debug_images", "save_cloud", "voxel"}}};
  info.choices = {{"camera", CameraPresetNames()},
                  {"depth_noise", DepthNoiseModelNames()},
                  {"cost", CostNames()},
                  {"loss", MEstimatorNames()},
                  {"scale", ScaleEstimatorNames()},
                  {"robust_schedule", RobustScheduleNames()},
                  {"initial_guess", OdometryGuessNames()},
                  {"on_lost", LostPolicyNames()},
                  {"assembly", AssemblyNames()},
                  {"frontend", FrontendNames()}};
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

OdometrySettings SettingsFromFlags() {
  OdometrySettings settings;
  settings.cost = FLAGS_cost;
  settings.loss = FLAGS_loss;
  settings.frontend = FLAGS_frontend;
  settings.assembly = FLAGS_assembly;
  settings.scale = FLAGS_scale;
  settings.robust_schedule = FLAGS_robust_schedule;
  settings.initial_guess = FLAGS_initial_guess;
  settings.on_lost = FLAGS_on_lost;
  settings.depth_noise = FLAGS_depth_noise;
  settings.max_features = FLAGS_max_features;
  return settings;
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

// A ground truth of another time is better told before the work than after it.
void CheckOverlap(const Dataset& dataset, const Trajectory& truth) {
  Trajectory frames(dataset.size());
  for (int i = 0; i < dataset.size(); ++i) {
    frames[i].timestamp = dataset.timestamp(i);
  }
  PairPoses(frames, truth, EvaluationOptions().max_time_difference);
}

// Nothing where none of the poses that were found can be compared.
std::optional<EvaluationReport> TryToEvaluate(const Trajectory& trajectory,
                                              const Trajectory& truth) {
  if (trajectory.empty()) return std::nullopt;
  try {
    return Evaluate(trajectory, truth, {});
  } catch (const InputError& error) {
    LOG(WARNING) << "no errors: " << error.what();
    return std::nullopt;
  }
}

// Draws what the odometry has made of the frame into a folder.
void WriteDebugImage(const std::filesystem::path& folder, const Frame& frame,
                     const TrackedFrame& tracked, const Camera& camera,
                     const Odometry& odometry) {
  char name[32];
  std::snprintf(name, sizeof(name), "%06d.png", tracked.index);
  std::string caption = "frame " + std::to_string(tracked.index) + "  " +
                        ToString(tracked.status);
  if (tracked.reference >= 0) {
    caption += "  " + std::to_string(tracked.inliers) + " of " +
               std::to_string(tracked.matches) + " matches agree  reference " +
               std::to_string(tracked.reference);
  }
  WritePngFile((folder / name).string(),
               DrawMatches(frame, camera, odometry.last_matches(),
                           odometry.last_estimate(), caption));
}

// Of the cloud that --save_cloud asks for; none if it asks for none.
std::optional<CloudFusion> MakeCloudFusion(const Camera& camera) {
  CloudFusionOptions options;
  options.camera = camera;
  options.voxel_size = FLAGS_voxel;
  const std::string problem = options.Check();
  if (!problem.empty()) throw InputError("--voxel: " + problem);
  if (FLAGS_save_cloud.empty()) return std::nullopt;
  return CloudFusion(options);
}

// Writes the cloud, and a few of its points in the world that the page of the
// run shows; returns what metrics.json says of it.
nlohmann::json SaveCloud(const CloudFusion& fusion,
                         const Rigid3d& shown_from_world,
                         const std::filesystem::path& folder,
                         std::string* text) {
  WritePly(FLAGS_save_cloud, fusion.cloud().Points());
  *text += "cloud       " + std::to_string(fusion.cloud().size()) +
           " points of " + std::to_string(fusion.frames()) + " frames in " +
           FLAGS_save_cloud + "\n";
  WriteFileAtomically(
      (folder / kCloudPreviewFile).string(),
      CloudPreview(fusion.cloud().Thin(kMaxPreviewPoints), shown_from_world)
          .dump());
  return {{"points", fusion.cloud().size()},
          {"frames", fusion.frames()},
          {"voxel_m", FLAGS_voxel}};
}

// The page is a help to look at a run; a program built without the library that
// it needs says so and goes on.
void WriteReport(const std::filesystem::path& folder, std::string* text) {
  if (!FLAGS_report) return;
  if (HasReportLibrary()) WriteRunReport(folder.string());
  *text += "report in   " +
           (HasReportLibrary() ? FLAGS_output + "/report.html"
                               : std::string(kNoReportLibrary)) +
           "\n";
}

int ValidateOnly(TumDataset* dataset, int threads) {
  const Clock::time_point start = Clock::now();
  std::vector<double> decode_ms;
  {
    ProgressBar bar("reading", dataset->size());
    decode_ms =
        ReadAllFrames(dataset, threads, [&bar](int done) { bar.Update(done); });
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
  if (FLAGS_validate_only) return ValidateOnly(&dataset, threads);
  Odometry odometry =
      MakeOdometry(SettingsFromFlags(), dataset.camera().camera);
  const std::optional<Trajectory> truth = FindGroundTruth();
  if (truth.has_value()) CheckOverlap(dataset, *truth);
  std::optional<MotionGuess> motion_guess;
  if (!FLAGS_motion_guess.empty()) {
    motion_guess.emplace(ReadTrajectory(FLAGS_motion_guess));
  }
  const FrameSelection drawn("debug_images", FLAGS_debug_images);
  const std::string warning = DepthScaleWarning(dataset.Read(0));
  std::optional<CloudFusion> fusion = MakeCloudFusion(dataset.camera().camera);
  RunFolder folder(FLAGS_output);
  const std::filesystem::path& output = folder.aside();
  const std::filesystem::path debug_folder = output / "debug";
  if (!FLAGS_debug_images.empty()) {
    std::filesystem::create_directory(debug_folder);
  }
  if (fusion.has_value()) RequireWritable(FLAGS_save_cloud);
  if (!warning.empty()) LOG(WARNING) << warning;
  if (dataset.unmatched_color() > 0) {
    LOG(WARNING) << dataset.unmatched_color()
                 << " colour images have no depth image within 0.02 s and "
                    "are left out";
  }

  std::vector<TrackedFrame> frames;
  ResidualHistogram residuals;
  {
    ProgressBar bar("tracking", dataset.size());
    RunOptions options;
    options.threads = threads;
    if (motion_guess.has_value()) options.motion_guess = &*motion_guess;
    options.on_frame = [&](const Frame& frame, const TrackedFrame& tracked) {
      if (drawn.Contains(tracked.index)) {
        WriteDebugImage(debug_folder, frame, tracked, dataset.camera().camera,
                        odometry);
      }
      if (fusion.has_value() && fusion->Wants(tracked)) {
        fusion->Add(frame, dataset.ReadColor(tracked.index),
                    tracked.world_from_cam);
      }
      if (tracked.status != TrackingStatus::kLost && tracked.matches > 0) {
        residuals.Add(odometry.last_estimate());
      }
      bar.Update(tracked.index + 1);
    };
    frames = RunOdometry(&dataset, &odometry, options);
  }
  const double seconds = SecondsSince(start);

  const Trajectory trajectory = TrackedTrajectory(frames);
  const RunSummary summary = Summarise(frames, threads, seconds);
  std::string text = FormatSummary(summary);
  nlohmann::json metrics = {{"program", "rgbd_odometry"},
                            {"dataset", FLAGS_dataset},
                            {"unmatched_color", dataset.unmatched_color()},
                            {"peak_rss_mb", PeakMemoryMb()},
                            {"run", SummaryToJson(summary)},
                            {"residuals", residuals.ToJson()}};
  Rigid3d shown_from_world;
  std::optional<EvaluationReport> report;
  if (truth.has_value()) report = TryToEvaluate(trajectory, *truth);
  if (report.has_value()) {
    text += FormatEvaluation(*report);
    metrics["evaluation"] = EvaluationToJson(*report);
    shown_from_world = report->truth_from_estimate;
    WriteFileAtomically((output / "errors.csv").string(),
                        FormatErrorsCsv(frames, *truth, *report));
  }
  if (fusion.has_value()) {
    metrics["cloud"] = SaveCloud(*fusion, shown_from_world, output, &text);
  }
  WriteFileAtomically((output / "trajectory.txt").string(),
                      FormatTrajectory(trajectory));
  WriteFileAtomically((output / "frames.csv").string(),
                      FormatFramesCsv(frames));
  WriteFileAtomically((output / "config.flags").string(),
                      FormatFlagFile(Info()));
  // The name of the dataset may be no UTF-8.
  WriteFileAtomically((output / "metrics.json").string(),
                      metrics.dump(2, ' ', /*ensure_ascii=*/false,
                                   nlohmann::json::error_handler_t::replace) +
                          "\n");
  WriteReport(output, &text);
  folder.Publish();
  std::printf("%sresults in  %s\n", text.c_str(), FLAGS_output.c_str());
  if (summary.TrackedShare() >= kMinTrackedShare) return kExitOk;
  std::fprintf(stderr,
               "rgbd_odometry: only %.1f %% of the frames were tracked; "
               "%s/frames.csv says why\n",
               100.0 * summary.TrackedShare(), FLAGS_output.c_str());
  return kExitTrackingFailed;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
