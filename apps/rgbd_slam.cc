// Estimates a map of an RGB-D sequence and the camera path in it: as
// rgbd_odometry, plus loop closure, saved maps and relocalisation.

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/calibration/calibration_run.h"
#include "apps/export/export_format.h"
#include "apps/pipeline/odometry_run.h"
#include "apps/pipeline/sequence.h"
#include "apps/report/report_page.h"
#include "apps/results/calibration_output.h"
#include "apps/results/run_output.h"
#include "apps/results/slam_output.h"
#include "apps/shell/program.h"
#include "apps/view/live_view.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/depth_noise_file.h"
#include "frontend/map/map_folder.h"

DEFINE_int32(threads, 0,
             "threads that read images ahead and track; 0: one for each core; "
             "the result does not depend on it");
DEFINE_bool(report, true, "write OUTPUT/report.html");
DEFINE_bool(calibrate, false,
            "first calibrate the camera as rgbd_calibrate does, and use the "
            "result (OUTPUT/camera.yaml) if it is better");

namespace rgbd_pose {
namespace {

struct ProgramSettings {
  SequenceSettings sequence;
  OdometrySettings odometry;
  SlamSettings slam;
  RunOutputSettings output;
  ViewSettings view;
  std::string save_map, load_map;
  bool localise_only = false;
};

std::vector<Setting> MapTable(ProgramSettings* settings) {
  constexpr std::string_view kGroup = "Maps";
  return {
      {"save_map", kGroup, "folder to save the map to; empty: it is not saved",
       &settings->save_map},
      {"load_map", kGroup,
       "map folder to continue with, or several, separated by commas, to join",
       &settings->load_map},
      {"localise_only", kGroup,
       "track within the loaded map without changing it",
       &settings->localise_only},
  };
}

ProgramInfo Info(ProgramSettings* settings) {
  return {"rgbd_slam",
          "estimates the path of an RGB-D camera and builds a map with loop "
          "closures.",
          "rgbd_slam --dataset=rgbd_dataset_freiburg1_room --camera=tum_fr1 "
          "--output=runs/fr1_room --save_map=maps/room",
          {{"Run", {"calibrate", "report", "finish_on_signal", "threads"}}},
          {SettingTable(&settings->sequence), SettingTable(&settings->odometry),
           SettingTable(&settings->slam), MapTable(settings),
           SettingTable(&settings->output), SettingTable(&settings->view)}};
}

void LoadMaps(const ProgramSettings& settings, Slam* slam) {
  std::vector<std::string> folders = SplitText(settings.load_map, ',');
  folders.erase(std::remove(folders.begin(), folders.end(), ""), folders.end());
  if (settings.localise_only && folders.empty()) {
    throw InputError("--localise_only needs --load_map");
  }
  if (settings.localise_only && !settings.save_map.empty()) {
    throw InputError(
        "--localise_only does not change the map; leave out --save_map");
  }
  for (const std::string& folder : folders) {
    Located("--load_map=" + folder,
            [&] { slam->Load(LoadMap(folder), settings.localise_only); });
  }
}

// The result of --calibrate, if it is requested.
std::optional<RecordingCalibration> Calibrate(const ProgramSettings& settings,
                                              int threads) {
  if (!FLAGS_calibrate) return std::nullopt;
  OpenSequence(settings.sequence);
  OdometrySettings odometry = settings.odometry;
  odometry.odometry.max_flow_px =
      std::min(odometry.odometry.max_flow_px,
               CalibrationOdometry().odometry.max_flow_px);
  return CalibrateWithProgress(settings.sequence, odometry, CalibrationSlam(),
                               {}, threads);
}

// Writes the calibration files and returns the text that the program prints.
// Afterwards the flags are those of a run with the camera found.
std::string WriteFound(const RecordingCalibration& found,
                       const ProgramSettings& settings,
                       const RunFolder& output) {
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
  if (FLAGS_report) {
    output.WriteFile("calibration.html", CalibrationPage(result, found.path));
  }
  return FormatCalibrationSummary(result) +
         (result.is_accepted ? "tracked with the new camera:\n"
                             : "tracked with the first camera:\n");
}

int Main(const ProgramSettings& settings, const ProgramInfo& info) {
  const auto start = std::chrono::steady_clock::now();
  RequireFlag("dataset", settings.sequence.dataset);
  RequireFlag("output", settings.output.output);
  const int threads = NumThreads(FLAGS_threads);

  // Check the input before the work starts and before anything is written.
  const bool keep_color = !settings.output.save_cloud.empty();
  const std::optional<RecordingCalibration> found =
      Calibrate(settings, threads);
  const bool has_camera = found.has_value() && found->result.is_accepted;
  Sequence sequence =
      OpenSequence(settings.sequence, keep_color,
                   has_camera ? &found->result.camera : nullptr);
  FrameSource& source = *sequence.source;
  Warn(sequence.remarks);
  if (!settings.save_map.empty()) RequireMapFolder(settings.save_map);
  SequenceRun run(settings.odometry, settings.slam, source.camera().camera,
                  sequence.inputs);
  LoadMaps(settings, run.slam());
  RequireMeshFrames(settings.output, settings.sequence.dataset);
  RunOutput output(settings.output, source, settings.odometry.features.depth);

  LiveView view(settings.sequence.dataset, settings.view,
                source.camera().camera, run);
  if (view.is_open()) {
    std::fprintf(stderr, "view on     %s\n", view.address().c_str());
  }

  const std::string stopped =
      TrackSource(&source, threads, &run, &output,
                  [&view](const Frame& frame, const auto& is_interrupted) {
                    return view.Add(frame, is_interrupted);
                  });
  const double seconds = SecondsSince(start);

  const RunResults results = run.Finish(sequence.GroundTruth());
  const Slam& slam = *run.slam();
  const nlohmann::json map_json = SlamToJson(slam, run.slam_frames());
  std::string text;
  nlohmann::json more = {{"stopped", stopped}, {"slam", map_json}};
  if (found.has_value()) {
    text = WriteFound(*found, settings, output.folder());
    more["calibration"] = CalibrationToJson(found->result);
  }
  text += output.Write(results, threads, seconds, sequence.GroundTruth(),
                       settings.sequence.dataset, info, more);
  Warn({SlamWarning(map_json)});
  text += FormatSlamSummary(map_json);
  const KeyframeMap map = slam.Map();
  output.folder().WriteFile("slam.csv", FormatSlamCsv(run.slam_frames()));
  output.folder().WriteFile("trajectory_online.txt",
                            FormatOnlineTrajectory(slam, run.slam_frames()));
  output.folder().WriteFile("trajectory_odometry.txt",
                            FormatTrajectory(SmoothPath(run.slam_frames())));
  output.folder().WriteFile("keyframes.csv",
                            FormatKeyframesCsv(map, slam.Covariances()));
  output.folder().WriteFile("graph.g2o",
                            FormatG2o(slam.Map(/*as_solved=*/true)));
  std::string no_report;
  if (FLAGS_report) {
    text += WriteRunPage(output.folder().staging_dir(), settings.output.output,
                         &no_report);
  }
  output.folder().Publish();
  text += SaveMesh(settings.output, threads);
  // If the map cannot be saved, the results stay.
  if (!settings.save_map.empty()) {
    SaveMap(settings.save_map, map);
    text += "map in      " + settings.save_map + "\n";
  }
  std::printf("%sresults in  %s\n", text.c_str(),
              settings.output.output.c_str());
  view.Finish(settings.output.output);
  return ExitCodeOf(info.name, results, settings.output.output, stopped,
                    no_report);
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
