#include "apps/run/run_tracking.h"

#include <gflags/gflags.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/export/export_format.h"
#include "apps/report/report_page.h"
#include "apps/results/calibration_output.h"
#include "apps/results/slam_output.h"
#include "apps/shell/progress_bar.h"
#include "apps/shell/stop_signal.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/depth_noise_file.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/slam/map_folder.h"

DEFINE_int32(threads, 0,
             "threads that read images ahead and track; 0: one for each core; "
             "the result does not depend on it");
DEFINE_bool(report, true, "write OUTPUT/report.html");
DEFINE_bool(
    finish_on_signal, true,
    "on SIGINT (Ctrl-C), SIGTERM or SIGHUP (a closed terminal) stop early "
    "and keep the results; a second Ctrl-C ends the program at once");

namespace rgbd_pose {
namespace {

// A run with a smaller share of tracked frames has failed.
constexpr double kMinTrackedShare = 0.5;

// Writes the calibration files and returns the text that the program prints.
// Afterwards the flags are those of a run with the camera found.
std::string WriteFound(const RecordingCalibration& found,
                       const RunSettings& settings, const RunFolder& output) {
  constexpr char kFile[] = "camera.yaml";
  const CalibrationResult& result = found.result;
  if (result.is_accepted) {
    output.WriteFile(kFile,
                     FormatCameraFile(result.camera, settings.sequence.camera));
    const std::filesystem::path folder(settings.output.output);
    gflags::SetCommandLineOption("camera", (folder / kFile).c_str());
    gflags::SetCommandLineOption("depth_scale", "0");
    gflags::SetCommandLineOption("calibrate", "false");
  }
  if (result.noise.has_value()) {
    output.WriteFile("depth_noise.yaml",
                     FormatDepthNoiseFile(result.noise->model));
  }
  if (FLAGS_report && HasReportLibrary()) {
    output.WriteFile("calibration.html", CalibrationPage(result, found.path));
  }
  return FormatCalibrationSummary(result) +
         (result.is_accepted ? "tracked with the new camera:\n"
                             : "tracked with the first camera:\n");
}

// Throws InputError for outputs that the run could not write at its end.
void RequirePossible(const RunOutputSettings& output,
                     const std::string& dataset) {
  const std::string& mesh = output.save_mesh;
  if (!(output.save_cloud + mesh).empty() &&
      !std::filesystem::exists(dataset)) {
    throw InputError(
        std::string(mesh.empty() ? "--save_cloud" : "--save_mesh") +
        " needs the frames a second time, but '" + dataset +
        "' is not a file or folder; record it with rgbd_convert first");
  }
  for (const auto& [flag, path] : {std::pair("output", output.output),
                                   {"record", output.record},
                                   {"save_cloud", output.save_cloud},
                                   {"save_mesh", output.save_mesh}}) {
    if (!path.empty()) RequireOutside(flag, path, dataset);
  }
}

// What metrics.json has besides the metrics of every run.
nlohmann::json MoreMetrics(const std::string& stopped,
                           const std::optional<RecordingCalibration>& found,
                           const SequenceRun& run) {
  nlohmann::json more = {{"stopped", stopped}};
  if (found.has_value()) more["calibration"] = CalibrationToJson(found->result);
  if (run.slam() != nullptr) {
    more["slam"] = SlamToJson(*run.slam(), run.slam_frames());
  }
  return more;
}

// Returns the text to print. `summary`: see SlamToJson.
std::string WriteMapTables(const SequenceRun& run,
                           const nlohmann::json& summary,
                           const RunFolder& output) {
  Warn({SlamWarning(summary)});
  const Slam& slam = *run.slam();
  output.WriteFile("slam.csv", FormatSlamCsv(slam, run.slam_frames()));
  output.WriteFile("trajectory_online.txt",
                   FormatOnlineTrajectory(slam, run.slam_frames()));
  output.WriteFile("trajectory_odometry.txt",
                   FormatTrajectory(SmoothPath(run.slam_frames())));
  output.WriteFile("keyframes.csv",
                   FormatKeyframesCsv(slam.Map(), slam.Covariances()));
  output.WriteFile("graph.g2o", FormatG2o(slam.Map(/*as_solved=*/true)));
  return FormatSlamSummary(summary);
}

// Returns the text that `write` returns. If it cannot write, the other results
// stay: adds why to `missing` and returns no text.
std::string TextOf(const std::function<std::string()>& write,
                   std::string* missing) {
  try {
    return write();
  } catch (const InputError& error) {
    *missing += (missing->empty() ? "" : "; ") + std::string(error.what());
    return "";
  }
}

// Writes the page from the files of the run, which are not yet published to
// `folder`. Returns the text to print.
std::string WritePage(const RunFolder& output, const std::string& folder) {
  const bool has_page = HasReportLibrary();
  if (has_page) WriteReport("run", output.staging_dir());
  return "report in   " +
         (has_page ? folder + "/report.html" : kNoReportLibrary) + "\n";
}

// Writes the cloud and the mesh of a published run, as far as requested.
// Returns the text to print. `missing`: see TextOf.
std::string FuseFrames(const RunOutputSettings& output, int threads,
                       std::string* missing) {
  ExportOptions options;
  options.voxel = output.voxel;
  options.threads = threads;
  std::string text;
  for (const auto& [file, fuse] : {std::pair(output.save_cloud, &ExportCloud),
                                   std::pair(output.save_mesh, &ExportMesh)}) {
    if (file.empty()) continue;
    options.output = file;
    const auto write = [&, fuse = fuse] {
      return fuse(FinishedRun(output.output), options);
    };
    text += TextOf(write, missing);
  }
  return text;
}

// Returns the exit code and prints one line on stderr unless it is kExitOk.
// `stopped`: why the run ended early; `missing`: why a result is missing.
int ExitCodeOf(const std::string& program, const RunResults& results,
               const std::string& folder, const std::string& stopped,
               const std::string& missing) {
  const auto end_with = [&](ExitCode code, const std::string& why) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), why.c_str());
    return code;
  };
  if (!missing.empty()) {
    return end_with(kExitBadInput,
                    missing + "; all other results are in " + folder);
  }
  if (results.TrackedShare() < kMinTrackedShare) {
    return end_with(
        kExitTrackingFailed,
        Format("only %.1f %% of the frames were tracked; see the reasons in ",
               100.0 * results.TrackedShare()) +
            folder + "/frames.csv");
  }
  if (!stopped.empty()) {
    return end_with(
        kExitStopped,
        Format("stopped after %zu frames (", results.frames.size()) + stopped +
            "); their results are in " + folder);
  }
  return kExitOk;
}

}  // namespace

std::string TrackSource(FrameSource* source, int threads, SequenceRun* run,
                        RunOutput* output, Ros2Recording* recording,
                        LiveView* view) {
  const StopSignal signal(FLAGS_finish_on_signal);
  const size_t size = source->timestamps().size();
  std::string ended_by;
  ProgressBar bar("tracking", static_cast<int>(size));
  std::string stopped =
      TrackAll(source, threads, {run}, [&](const Frame& frame) {
        if (run->frames().size() == 1) {
          Warn({source->camera().camera.SanityWarning(),
                DepthScaleWarning(frame)});
        }
        output->Add(frame, *run);
        if (recording != nullptr) recording->Add(frame, *run);
        bar.Update(static_cast<int>(run->frames().size()));
        ended_by = view->Add(frame, [&] { return !signal.name().empty(); });
        if (!signal.name().empty()) ended_by = signal.name();
        return ended_by.empty();
      });
  Warn(DroppedFrames(*source, run->damaged(), run->odometry().repeated()));
  if (!stopped.empty()) return stopped;
  return run->frames().size() + run->damaged().size() == size ? "" : ended_by;
}

int TrackAndWrite(const RunSettings& settings, const ProgramInfo& info,
                  std::chrono::steady_clock::time_point start,
                  Sequence* sequence, SequenceRun* run,
                  const std::optional<RecordingCalibration>& found) {
  const int threads = NumThreads(FLAGS_threads);
  const std::string& dataset = settings.sequence.dataset;
  const std::string& folder = settings.output.output;
  RequirePossible(settings.output, dataset);
  FrameSource& source = *sequence->source;
  RunOutput output(settings.output, source, settings.odometry);
  const size_t known_frames = source.timestamps().size();
  if (known_frames > 0) output.WarnOfMissingImages(known_frames);
  std::optional<Ros2Recording> recording;
  if (!settings.output.record.empty()) {
    recording.emplace(settings.output.record, source);
  }
  LiveView view(dataset, settings.view, source.camera().camera, *run);
  if (view.is_open()) {
    std::fprintf(stderr, "view on     %s\n", view.address().c_str());
  }
  const std::string stopped =
      TrackSource(&source, threads, run, &output,
                  recording.has_value() ? &*recording : nullptr, &view);
  const double seconds = SecondsSince(start);
  if (known_frames == 0) output.WarnOfMissingImages(run->frames().size());

  std::string text, missing;
  std::string recorded;
  // This comes first, because a live camera repeats nothing.
  if (recording.has_value()) {
    recorded = TextOf([&] { return recording->Finish(); }, &missing);
  }
  const Trajectory* const truth = sequence->GroundTruth();
  const RunResults results = run->Finish(truth);
  const nlohmann::json more = MoreMetrics(stopped, found, *run);
  if (found.has_value()) text += WriteFound(*found, settings, output.folder());
  text += output.Write(results, threads, seconds, truth, dataset, info, more);
  const Slam* const slam = run->slam();
  if (slam != nullptr) {
    text += WriteMapTables(*run, more["slam"], output.folder());
  }
  text += recorded;
  if (FLAGS_report) {
    text +=
        TextOf([&] { return WritePage(output.folder(), folder); }, &missing);
  }
  output.folder().Publish();
  if (!settings.save_map.empty()) {
    const auto save = [&] {
      // Lost frames are segments of their own, which would only swell a map.
      if (results.TrackedShare() < kMinTrackedShare &&
          HasMap(settings.save_map)) {
        return "map         not saved: most frames were lost; that in " +
               settings.save_map + " stays as it was\n";
      }
      SaveMap(settings.save_map, slam->Map());
      return "map in      " + settings.save_map + "\n";
    };
    text += TextOf(save, &missing);
  }
  if (!results.trajectory.empty()) {
    text += FuseFrames(settings.output, threads, &missing);
  }
  std::printf("%sresults in  %s\n", text.c_str(), folder.c_str());
  view.Finish(folder);
  return ExitCodeOf(info.name, results, folder, stopped, missing);
}

}  // namespace rgbd_pose
