// Estimates a map of an RGB-D sequence and the camera path in it: what
// rgbd_odometry does, plus loop closure, saved maps and relocalisation.

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "apps/results/calibration_output.h"
#include "apps/run/run_tracking.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/calibration/calibration_run.h"
#include "frontend/settings/sequence.h"
#include "frontend/slam/map_folder.h"
#include "frontend/slam/sequence_run.h"

DEFINE_bool(calibrate, false,
            "first calibrate the camera as rgbd_calibrate does, and use the "
            "result (OUTPUT/camera.yaml) if it is better");

namespace rgbd_pose {
namespace {

struct ProgramSettings : RunSettings {
  SlamSettings slam;
  std::string load_map;
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
          "rgbd_slam rgbd_dataset_freiburg1_room --camera=tum_fr1 "
          "--save_map=maps/room",
          {{"Run", {"calibrate", "report", "finish_on_signal", "threads"}}},
          {SettingTable(&settings->sequence), SettingTable(&settings->odometry),
           SettingTable(&settings->slam), MapTable(settings),
           SettingTable(&settings->output), SettingTable(&settings->view)},
          {},
          /*has_default_output=*/true};
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
    if (std::count(folders.begin(), folders.end(), folder) > 1) {
      throw InputError("--load_map: '" + folder + "' appears twice");
    }
    KeyframeMap map = Located("--load_map", [&] { return LoadMap(folder); });
    Located("--load_map: " + folder,
            [&] { slam->Load(std::move(map), settings.localise_only); });
  }
}

// Throws InputError if no map can be saved where it is requested.
void RequireMapToSave(const ProgramSettings& settings) {
  if (settings.save_map.empty()) return;
  RequireOtherFolder("save_map", settings.save_map, settings.output.output);
  RequireOutside("save_map", settings.save_map, settings.sequence.dataset);
  RequireMapFolder(settings.save_map);
}

// The result of --calibrate, if it is requested.
std::optional<RecordingCalibration> Calibrate(const ProgramSettings& settings,
                                              int threads) {
  if (!FLAGS_calibrate) return std::nullopt;
  if (!settings.load_map.empty()) {
    throw InputError(
        "--calibrate changes the camera, which --load_map must keep; calibrate "
        "before the map is made");
  }
  RequireOutside("output", settings.output.output, settings.sequence.dataset);
  RunOutput(settings.output, *OpenSequence(settings.sequence).source,
            settings.odometry);
  RequireMapToSave(settings);
  OdometrySettings odometry = settings.odometry;
  odometry.odometry.max_flow_px =
      std::min(odometry.odometry.max_flow_px,
               CalibrationOdometry().odometry.max_flow_px);
  return CalibrateWithProgress(settings.sequence, odometry, CalibrationSlam(),
                               {}, threads);
}

int Main(const ProgramSettings& settings, const ProgramInfo& info) {
  const auto start = std::chrono::steady_clock::now();
  RequireFlag("dataset", settings.sequence.dataset);
  const int threads = NumThreads(FLAGS_threads);

  // Check the input before the work starts and before anything is written.
  const std::optional<RecordingCalibration> found =
      Calibrate(settings, threads);
  const bool has_camera = found.has_value() && found->result.is_accepted;
  Sequence sequence =
      OpenSequence(settings.sequence, settings.wants_color(),
                   has_camera ? &found->result.camera : nullptr);
  Warn(sequence.remarks);
  RequireMapToSave(settings);
  SequenceRun run(settings.odometry, settings.slam, sequence.source->camera(),
                  sequence.inputs);
  LoadMaps(settings, run.slam());
  return TrackAndWrite(settings, info, start, &sequence, &run, found);
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
