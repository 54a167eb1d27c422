// Judges an estimated trajectory against the ground truth.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <cstdio>

#include "apps/results/evaluation_report.h"
#include "apps/shell/program.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

DEFINE_string(estimate, "", "the estimated trajectory, as TUM text");
DEFINE_string(groundtruth, "", "the true trajectory, as TUM text");
DEFINE_double(max_time_difference,
              rgbd_pose::EvaluationOptions().max_time_difference,
              "pair poses at most this far apart in time, in seconds");
DEFINE_double(rpe_delta_seconds,
              rgbd_pose::EvaluationOptions().rpe_delta_seconds,
              "interval of the relative pose error in time, in seconds");
DEFINE_double(rpe_delta_metres, rgbd_pose::EvaluationOptions().rpe_delta_metres,
              "interval of the relative pose error along the path of the "
              "ground truth, in metres");
DEFINE_bool(json, false, "print JSON instead of a table");
DEFINE_string(aligned, "",
              "write the estimate, moved by the alignment into the world of "
              "the ground truth, to this file (TUM text; for plots)");

namespace rgbd_pose {
namespace {

ProgramInfo Info() {
  return {"rgbd_evaluate",
          "judges an estimated trajectory against the ground truth.",
          "rgbd_evaluate --estimate=trajectory.txt "
          "--groundtruth=groundtruth.txt",
          {{"Input", {"estimate", "groundtruth"}},
           {"Definitions",
            {"max_time_difference", "rpe_delta_seconds", "rpe_delta_metres"}},
           {"Output", {"json", "aligned"}}}};
}

void WriteAligned(const Trajectory& estimate,
                  const Rigid3d& truth_from_estimate, const std::string& path) {
  Trajectory aligned = estimate;
  for (StampedPose& pose : aligned) {
    pose.world_from_cam = truth_from_estimate * pose.world_from_cam;
  }
  WriteFileAtomically(path, FormatTrajectory(aligned));
}

int Main() {
  RequireFlag("estimate", FLAGS_estimate);
  RequireFlag("groundtruth", FLAGS_groundtruth);
  const Trajectory estimate = ReadTrajectory(FLAGS_estimate);
  const EvaluationReport report =
      Evaluate(estimate, ReadTrajectory(FLAGS_groundtruth),
               {FLAGS_max_time_difference, FLAGS_rpe_delta_seconds,
                FLAGS_rpe_delta_metres});
  if (!FLAGS_aligned.empty()) {
    WriteAligned(estimate, report.truth_from_estimate, FLAGS_aligned);
  }
  const std::string warning = LikenessWarning(report.likeness, report.ate.rmse);
  if (!warning.empty()) LOG(WARNING) << warning;
  const std::string text = FLAGS_json ? EvaluationToJson(report).dump(2) + "\n"
                                      : FormatEvaluation(report);
  std::fputs(text.c_str(), stdout);
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
