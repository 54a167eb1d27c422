// Repeats the experiments of the thesis' fourth chapter, which compare
// M-estimators.

#include <gflags/gflags.h>

#include <cstdio>

#include "apps/compare/experiment.h"
#include "apps/report/report_page.h"
#include "apps/shell/program.h"
#include "core/geometry/camera.h"
#include "frontend/settings/settings.h"
#include "robust/m_estimator.h"

DEFINE_bool(report, true, "write OUTPUT/report.html");
DEFINE_string(output, "", "folder for the results, created if missing");

namespace rgbd_pose {
namespace {

std::vector<Setting> ExperimentTable(ExperimentSettings* settings) {
  constexpr std::string_view kGroup = "Experiment";
  return {
      {"experiment", kGroup,
       "pan_tilt or xyz (simulated), sweep (wrong matches), or the folder of a "
       "sequence in TUM RGB-D layout, best with groundtruth.txt",
       &settings->experiment},
      {"losses", kGroup,
       "M-estimators, separated by commas; empty: all in a sweep, else "
       "none,huber,cauchy,geman_mcclure,welsch,tukey",
       &settings->losses, MEstimatorNames()},
      {"camera", kGroup,
       "YAML file or preset; empty: ros_default where simulated",
       &settings->camera, CameraPresetNames()},
      {"frames", kGroup, "frames of a simulated sequence", &settings->frames},
      {"seeds", kGroup, "trials of a sweep at each share of wrong matches",
       &settings->seeds},
  };
}

ProgramInfo Info(ExperimentSettings* settings) {
  return {"rgbd_compare",
          "compares M-estimators as the thesis' fourth chapter does: by "
          "features alone, unless --tracker says otherwise.",
          "rgbd_compare --experiment=xyz --output=compare/xyz",
          {{"Output", {"output", "report"}}},
          {ExperimentTable(settings),
           WithoutRow("loss", SettingTable(&settings->odometry))}};
}

int Main(const ExperimentSettings& settings, const ProgramInfo& info) {
  RequireFlag("experiment", settings.experiment);
  RequireFlag("output", FLAGS_output);
  const ExperimentResult result = RunExperiment(settings, FLAGS_output);
  WriteOutput(FLAGS_output, "config.flags", FormatFlagFile(info));
  WriteOutput(FLAGS_output, "report.md", result.report);
  std::printf("%s", result.report.c_str());
  if (FLAGS_report) {
    std::printf("report in   %s\n",
                HasReportLibrary()
                    ? WriteReport("comparison", FLAGS_output).c_str()
                    : kNoReportLibrary);
  }
  if (!result.is_usable) return kExitTrackingFailed;
  return result.has_stopped ? kExitStopped : kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
