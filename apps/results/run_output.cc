#include "apps/results/run_output.h"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "apps/results/evaluation_report.h"
#include "apps/results/evaluation_summary.h"
#include "apps/results/frame_tables.h"
#include "apps/results/inertial_output.h"
#include "apps/results/run_summary.h"
#include "apps/results/tracking_pictures.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/frame_rectifier.h"
#include "frontend/fusion/mesh_file.h"
#include "frontend/fusion/mesh_fusion.h"

namespace rgbd_pose {
namespace {

// Scatter of stamps below this moves no surface noticeably.
constexpr double kNoticedJitterMs = 0.2;

constexpr char kDebug[] = "debug";

nlohmann::json ShutterToJson(const RgbdCamera& camera) {
  const auto both = [](const Shutter& shutter) -> nlohmann::json {
    return {{"offset_ms", 1e3 * shutter.offset},
            {"readout_ms", 1e3 * shutter.readout}};
  };
  return {{"color", both(camera.color_shutter)},
          {"depth", both(camera.depth_shutter)}};
}

// Of the stamps of depth images relative to colour, and of their scatter.
nlohmann::json DepthStampsToJson(const std::vector<double>& stamps_ms,
                                 const std::vector<double>& jitters_ms) {
  if (stamps_ms.empty()) return {};
  return {{"least", Quantile(stamps_ms, 0.0)},
          {"median", Median(stamps_ms)},
          {"most", Quantile(stamps_ms, 1.0)},
          {"jitter", Median(jitters_ms)}};
}

nlohmann::json ResidualsToJson(const ResidualHistogram& residuals) {
  return {{"matches", residuals.matches},
          {"norm_bin", residuals.kNormBin},
          {"norm_counts", residuals.norms},
          {"norms_above", residuals.norms_above},
          {"weight_bin", residuals.kWeightBin},
          {"weight_counts", residuals.weights},
          {"weights_zero", residuals.weights_zero},
          {"degrees_counts", residuals.degrees}};
}

// Warns of what the errors of a run suggest about its input.
void WarnOfInput(const RunResults& results,
                 const std::vector<double>& jitters_ms) {
  const double jitter_ms = jitters_ms.empty() ? 0.0 : Median(jitters_ms);
  if (jitter_ms > kNoticedJitterMs) {
    Warn(
        {Format("the stamps of depth images scatter by %.1f ms against those "
                "of colour; covariances allow for it",
                jitter_ms)});
  }
  if (!results.no_evaluation.empty()) {
    Warn({"no evaluation: " + results.no_evaluation});
  }
  if (results.evaluation.has_value()) {
    Warn({Sim3Warning(results.evaluation->sim3, results.evaluation->ate.rmse)});
  }
}

void WriteDebugImage(const std::filesystem::path& folder, const Frame& frame,
                     const TrackedFrame& tracked, const Camera& camera,
                     const Odometry& odometry) {
  std::string caption =
      Format("frame %d  %s", tracked.index, ToString(tracked.status));
  if (tracked.reference >= 0) {
    caption += Format("  %d of %d matches agree  reference %d", tracked.inliers,
                      tracked.matches, tracked.reference);
  }
  WritePngFile(folder / Format("%06d.png", tracked.index),
               DrawMatches(frame, camera, odometry.last_matches(),
                           odometry.last_estimate(), caption));
  const OdometryKeyframe* keyframe = odometry.FindKeyframe(tracked.reference);
  if (tracked.status != TrackingStatus::kLost && keyframe != nullptr &&
      keyframe->reference->pixels != nullptr) {
    WritePngFile(folder / Format("%06d_residuals.png", tracked.index),
                 DrawResiduals(keyframe->reference->pixels->view, frame,
                               odometry.last_estimate().cur_from_prev));
  }
}

}  // namespace

std::vector<Setting> SettingTable(RunOutputSettings* settings) {
  constexpr std::string_view kGroup = "Output";
  return {
      {"output", kGroup,
       "folder for the results, created if missing; empty: a new one, "
       "runs/NAME "
       "of the recording",
       &settings->output},
      {"debug_images", kGroup,
       "frames for which OUTPUT/debug gets images of the matches, coloured by "
       "robust weight, and of pixel residuals: all, or numbers and ranges such "
       "as 10,20-40:5",
       &settings->debug_images},
      {"save_cloud", kGroup,
       "file for a coloured point cloud (.ply), fused with the final poses "
       "after the run, which reads the frames again; empty: none",
       &settings->save_cloud},
      {"save_mesh", kGroup, "the same for a coloured mesh (.ply or .glb)",
       &settings->save_mesh},
      {"record", kGroup,
       "new file (.mcap) that is written during the run for ROS 2: images, "
       "odometry with covariances, transforms; empty: none",
       &settings->record},
      {"voxel", kGroup, "voxel size (m) of the cloud and the mesh",
       &settings->voxel},
  };
}

RunOutput::RunOutput(const RunOutputSettings& settings,
                     const FrameSource& source,
                     const OdometrySettings& odometry)
    : source_(source),
      drawn_("debug_images", settings.debug_images),
      folder_(settings.output) {
  const MeshFusionOptions fusion = {
      {source.camera().camera, settings.voxel,
       FeaturesFor(odometry, source.camera()).depth}};
  RequireSound(settings.save_mesh.empty() ? fusion.FusionOptions::Check()
                                          : fusion.Check(),
               "--voxel or --max_depth: ");
  if (!settings.debug_images.empty()) {
    std::filesystem::create_directory(folder_.staging_dir() / kDebug);
  }
  if (!settings.save_mesh.empty()) RequireMeshFile(settings.save_mesh);
  if (!settings.save_cloud.empty()) RequireCloudFile(settings.save_cloud);
  if (!settings.save_mesh.empty() &&
      IsSamePlace(settings.save_cloud, settings.save_mesh)) {
    throw InputError("--save_cloud and --save_mesh are the same file");
  }
}

void RunOutput::WarnOfMissingImages(size_t frames) const {
  const int last = drawn_.LastBegin();
  if (last < static_cast<int>(frames)) return;
  Warn(
      {Format("--debug_images: there is no frame %d; the %zu frames are "
              "numbered from 0",
              last, frames)});
}

void RunOutput::Add(const Frame& frame, const SequenceRun& run) {
  depth_stamps_ms_.push_back(1e3 * frame.depth_delay);
  const auto& frames = run.frames();
  stamp_jitter_.Add(
      frame.depth_delay,
      frames.size() < 2
          ? 0.0
          : frame.timestamp - frames[frames.size() - 2].timestamp);
  jitters_ms_.push_back(1e3 * stamp_jitter_.sigma());
  const TrackedFrame& tracked = run.frames().back();
  if (!drawn_.Contains(tracked.index)) return;
  const Camera& camera = source_.camera().camera;
  Frame seen = frame;
  seen.twist = run.odometry().last_twist();
  seen = FrameRectifier(camera).Rectify(seen);
  WriteDebugImage(folder_.staging_dir() / kDebug, seen, tracked, camera,
                  run.odometry());
}

std::string RunOutput::Write(const RunResults& results, int threads,
                             double seconds, const Trajectory* truth,
                             const std::string& dataset,
                             const ProgramInfo& info,
                             const nlohmann::json& more) {
  const nlohmann::json summary = Summarise(results.frames, threads, seconds);
  const nlohmann::json jumps = FindJumps(results.frames);
  std::string text = FormatSummary(summary) + FormatJumps(jumps);
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);  // ru_maxrss is in KiB
  nlohmann::json metrics = {
      {"program", info.name},
      {"dataset", dataset},
      {"unmatched_color", source_.unmatched_color()},
      {"dropped_frames", source_.dropped()},
      {"damaged_frames", results.damaged.size()},
      {"repeated_color", results.repeated.color},
      {"repeated_depth", results.repeated.depth},
      {"remarks", source_.remarks()},
      {"peak_rss_mb", usage.ru_maxrss * 1024 / 1e6},
      {"run", summary},
      {"jumps", jumps},
      {"shutter", ShutterToJson(source_.camera())},
      {"depth_stamp_ms", DepthStampsToJson(depth_stamps_ms_, jitters_ms_)},
      {"residuals", ResidualsToJson(results.residuals)}};
  metrics.update(more);
  if (results.gravity.has_value()) {
    metrics["gravity"] = GravityToJson(*results.gravity);
    text += FormatGravity(metrics["gravity"]);
  }
  if (results.imu.has_value()) {
    metrics["gyroscope"] = GyroscopeToJson(*results.imu);
    text += FormatGyroscope(metrics["gyroscope"]);
  }
  WarnOfInput(results, jitters_ms_);
  if (results.evaluation.has_value()) {
    text += FormatEvaluationSummary(*results.evaluation) + "all errors  in " +
            (folder_.staging_dir().parent_path() / "metrics.json").string() +
            "\n";
    metrics["evaluation"] = EvaluationToJson(*results.evaluation);
    folder_.WriteFile("errors.csv",
                      FormatErrorsCsv(results.frames, results.trajectory,
                                      *truth, *results.evaluation));
  }
  folder_.WriteFile("trajectory.txt", FormatTrajectory(results.trajectory));
  folder_.WriteFile("frames.csv", FormatFramesCsv(results.frames));
  folder_.WriteFile("edges.csv", FormatEdgesCsv(results.frames));
  folder_.WriteFile("config.flags", FormatFlagFile(info));
  // The name of the dataset may be invalid UTF-8.
  folder_.WriteFile("metrics.json",
                    metrics.dump(2, ' ', /*ensure_ascii=*/false,
                                 nlohmann::json::error_handler_t::replace) +
                        "\n");
  return text;
}

}  // namespace rgbd_pose
