// Calibrates an RGB-D camera from its own recording.

#include <gflags/gflags.h>

#include <chrono>
#include <cstdio>

#include "apps/calibration/calibration_run.h"
#include "apps/report/report_page.h"
#include "apps/results/calibration_output.h"
#include "apps/shell/program.h"

DEFINE_int32(threads, 0, "threads; 0: one for each core");
DEFINE_bool(report, true, "write OUTPUT/report.html");
DEFINE_string(output, "", "folder to create for the results");

namespace rgbd_pose {
namespace {

struct ProgramSettings {
  SequenceSettings sequence;
  OdometrySettings odometry = CalibrationOdometry();
  SlamSettings slam = CalibrationSlam();
  CalibrationSettings calibration;
};

ProgramInfo Info(ProgramSettings* settings) {
  return {
      "rgbd_calibrate",
      "calibrates an RGB-D camera from its own recording.",
      "rgbd_calibrate --dataset=my_recording --camera=my_camera.yaml "
      "--output=calibration",
      {{"Run", {"output", "report", "threads"}}},
      {SettingTable(&settings->sequence), SettingTable(&settings->odometry),
       SettingTable(&settings->slam), SettingTable(&settings->calibration)}};
}

int Main(const ProgramSettings& settings, const ProgramInfo& info) {
  RequireFlag("dataset", settings.sequence.dataset);
  RequireFlag("output", FLAGS_output);
  const int threads = NumThreads(FLAGS_threads);

  // Check the input before anything is created.
  OpenSequence(settings.sequence);
  RunFolder folder(FLAGS_output);
  const auto start = std::chrono::steady_clock::now();
  const RecordingCalibration calibration =
      CalibrateWithProgress(settings.sequence, settings.odometry, settings.slam,
                            settings.calibration, threads);
  const CalibrationResult& result = calibration.result;
  const double seconds = SecondsSince(start);
  WriteCalibration(calibration, settings.sequence.camera, FormatFlagFile(info),
                   seconds, folder);
  if (FLAGS_report) {
    folder.WriteFile("report.html", CalibrationPage(result, calibration.path));
  }
  folder.Publish();
  std::printf("%s%.1f s; results in %s\n",
              FormatCalibrationSummary(result).c_str(), seconds,
              FLAGS_output.c_str());
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
