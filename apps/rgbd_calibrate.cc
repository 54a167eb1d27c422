// Calibrates an RGB-D camera from its own recording.

#include <gflags/gflags.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/report/report_page.h"
#include "apps/results/calibration_output.h"
#include "apps/results/run_folder.h"
#include "apps/shell/program.h"
#include "core/util/format.h"
#include "frontend/calibration/calibration_run.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/depth_noise_file.h"

DEFINE_int32(threads, 0, "threads; 0: one for each core");
DEFINE_bool(report, true, "write OUTPUT/report.html");
DEFINE_string(
    output, "",
    "folder for the results, new or of an earlier run; empty: a new one, "
    "runs/NAME of the recording");

namespace rgbd_pose {
namespace {

struct ProgramSettings {
  SequenceSettings sequence;
  OdometrySettings odometry = CalibrationOdometry();
  SlamSettings slam = CalibrationSlam();
  CalibrationSettings calibration;
};

ProgramInfo Info(ProgramSettings* settings) {
  return {"rgbd_calibrate",
          "calibrates an RGB-D camera from its own recording.",
          "rgbd_calibrate my_recording --camera=my_camera.yaml "
          "--output=calibration",
          {{"Run", {"output", "report", "threads"}}},
          {SettingTable(&settings->sequence), SettingTable(&settings->odometry),
           SettingTable(&settings->slam), SettingTable(&settings->calibration)},
          {},
          /*has_default_output=*/true};
}

std::string FormatResiduals(const CalibrationResult& result) {
  std::string text = "u,v,before_u,before_v,after_u,after_v,flow_u,flow_v\n";
  for (const HeldOutResidual& r : result.residuals) {
    text += Format("%.2f,%.2f,%.4f,%.4f,%.4f,%.4f,%.2f,%.2f\n", r.u, r.v,
                   r.before.x(), r.before.y(), r.after.x(), r.after.y(),
                   r.flow.x(), r.flow.y());
  }
  return text;
}

int Main(const ProgramSettings& settings, const ProgramInfo& info) {
  RequireFlag("dataset", settings.sequence.dataset);
  const int threads = NumThreads(FLAGS_threads);

  // Check the input before anything is created.
  OpenSequence(settings.sequence);
  RequireOutside("output", FLAGS_output, settings.sequence.dataset);
  RunFolder folder(FLAGS_output);
  const auto start = std::chrono::steady_clock::now();
  const RecordingCalibration calibration =
      CalibrateWithProgress(settings.sequence, settings.odometry, settings.slam,
                            settings.calibration, threads);
  const CalibrationResult& result = calibration.result;
  const double seconds = SecondsSince(start);
  folder.WriteFile("camera.yaml",
                   FormatCameraFile(result.camera, settings.sequence.camera));
  if (result.noise.has_value()) {
    folder.WriteFile("depth_noise.yaml",
                     FormatDepthNoiseFile(result.noise->model));
  }
  folder.WriteFile("residuals.csv", FormatResiduals(result));
  folder.WriteFile("config.flags", FormatFlagFile(info));
  const nlohmann::json metrics = {{"program", info.name},
                                  {"seconds", seconds},
                                  {"stopped", calibration.stopped},
                                  {"damaged_frames", calibration.damaged},
                                  {"calibration", CalibrationToJson(result)}};
  folder.WriteFile("metrics.json", metrics.dump(2) + "\n");
  if (FLAGS_report && HasReportLibrary()) {
    folder.WriteFile("report.html", CalibrationPage(result, calibration.path));
  }
  folder.Publish();
  std::printf("%s%.1f s; results in %s\n",
              FormatCalibrationSummary(result).c_str(), seconds,
              FLAGS_output.c_str());
  if (FLAGS_report) {
    std::printf("report in   %s\n",
                HasReportLibrary() ? (FLAGS_output + "/report.html").c_str()
                                   : kNoReportLibrary);
  }
  if (!calibration.stopped.empty()) {
    std::fprintf(stderr, "%s: stopped early (%s); results so far are in %s\n",
                 info.name.c_str(), calibration.stopped.c_str(),
                 FLAGS_output.c_str());
    return kExitStopped;
  }
  return result.is_accepted ? kExitOk : kExitCameraKept;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
