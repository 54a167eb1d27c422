// Evaluates an estimated trajectory against the ground truth.

#include <gflags/gflags.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/results/evaluation_report.h"
#include "apps/results/frame_tables.h"
#include "apps/shell/program.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/units.h"
#include "frontend/slam/sequence_run.h"

DEFINE_string(estimate, "", "the estimated trajectory, as TUM text");
DEFINE_string(run, "",
              "results folder of rgbd_odometry or rgbd_slam, instead of "
              "--estimate: motions are also checked against their covariances");
DEFINE_string(groundtruth, "", "the true trajectory, as TUM text");
DEFINE_string(align, "rigid",
              "alignment of the estimate before positions are compared: rigid: "
              "best rotation and translation; none: it is already in the world "
              "frame of the ground truth, such as poses in a map");
DEFINE_double(max_time_difference,
              rgbd_pose::EvaluationOptions().max_time_difference,
              "maximum time difference (s) of paired poses");
DEFINE_double(rpe_delta_seconds,
              rgbd_pose::EvaluationOptions().rpe_delta_seconds,
              "interval of the relative pose error in time, in seconds");
DEFINE_double(rpe_delta_metres, rgbd_pose::EvaluationOptions().rpe_delta_metres,
              "interval of the relative pose error along the path of the "
              "ground truth, in metres");
DEFINE_string(rpe_frames, "1,6",
              "numbers of frames over which the median, 90 % and 99 % of the "
              "relative pose error are given, separated by commas");
DEFINE_double(truth_sigma_metres, -1.0,
              "standard deviation (m) of motions of the ground truth, used "
              "when covariances are judged; -1: as its file says");
DEFINE_double(truth_sigma_degrees, -1.0,
              "standard deviation (degrees) of rotations of the ground truth, "
              "used when covariances are judged; -1: as its file says");
DEFINE_bool(json, false, "print JSON instead of a table");
DEFINE_string(aligned, "",
              "write the estimate, aligned to the ground truth, to this file "
              "(TUM text; for plots)");

namespace rgbd_pose {
namespace {

ProgramInfo Info() {
  return {
      "rgbd_evaluate",
      "evaluates an estimated trajectory against the ground truth.",
      "rgbd_evaluate --estimate=trajectory.txt --groundtruth=groundtruth.txt",
      {{"Input", {"estimate", "run", "groundtruth"}},
       {"Definitions",
        {"align", "max_time_difference", "rpe_delta_seconds",
         "rpe_delta_metres", "rpe_frames", "truth_sigma_metres",
         "truth_sigma_degrees"}},
       {"Output", {"json", "aligned"}}}};
}

std::vector<int> ParseFrames(const std::string& text) {
  std::vector<int> frames;
  if (text.empty()) return frames;
  for (const std::string& word : SplitList(text)) {
    frames.push_back(ParseWhole(word).value_or(0));
    if (frames.back() < 1) {
      throw InputError("--rpe_frames=" + text + ": '" + word +
                       "' is not a number of frames; give a list such as 1,6");
    }
  }
  return frames;
}

// The noise of the truth is what its file says, unless flags say otherwise.
TruthNoise NoiseOfTruth() {
  TruthNoise noise = ReadTruthNoise(FLAGS_groundtruth);
  const auto take = [&noise](double flag, double unit, double* sigma) {
    if (flag == -1.0) return;
    if (!(flag >= 0.0) || !std::isfinite(flag)) {
      throw InputError(
          "sigmas of the ground truth must not be negative or infinite");
    }
    *sigma = flag * unit;
    noise.origin = "as the flags say";
  };
  take(FLAGS_truth_sigma_metres, 1.0, &noise.translation);
  take(FLAGS_truth_sigma_degrees, kRadiansPerDegree, &noise.rotation);
  return noise;
}

// Throws InputError if --aligned would replace a trajectory that is read.
void RequireNewAligned(const std::string& input) {
  std::error_code error;
  if (!std::filesystem::equivalent(FLAGS_aligned, input, error)) return;
  throw InputError("--aligned=" + FLAGS_aligned + ": would replace " + input +
                   ", which is read; choose another file");
}

int Main() {
  const std::filesystem::path run = FLAGS_run;
  if (!FLAGS_run.empty() && !FLAGS_estimate.empty()) {
    throw InputError("--run contains a trajectory; leave out --estimate");
  }
  if (FLAGS_align != "rigid" && FLAGS_align != "none") {
    throw InputError("--align=" + FLAGS_align + " is neither rigid nor none");
  }
  if (FLAGS_run.empty()) RequireFlag("estimate", FLAGS_estimate);
  RequireFlag("groundtruth", FLAGS_groundtruth);
  const std::string estimate_file =
      FLAGS_run.empty() ? FLAGS_estimate : (run / "trajectory.txt").string();
  for (const std::string& input : {estimate_file, FLAGS_groundtruth}) {
    RequireNewAligned(input);
  }
  std::vector<std::string> remarks;
  Trajectory estimate = ReadTrajectory(estimate_file, &remarks);
  const Trajectory truth = ReadTrajectory(FLAGS_groundtruth, &remarks);
  Warn(remarks);
  const TruthNoise noise = NoiseOfTruth();
  EvaluationReport report =
      Evaluate(estimate, truth,
               {FLAGS_max_time_difference, FLAGS_rpe_delta_seconds,
                FLAGS_rpe_delta_metres, ParseFrames(FLAGS_rpe_frames),
                FLAGS_align == "rigid"});
  if (!FLAGS_run.empty()) {
    report.consistency =
        JudgeFrames(ReadFrames(run), truth, noise, report.truth_alignment);
  }
  if (!FLAGS_aligned.empty()) {
    for (StampedPose& pose : estimate) {
      pose.world_from_cam = report.truth_from_estimate * pose.world_from_cam;
    }
    WriteFileAtomically(FLAGS_aligned, FormatTrajectory(estimate));
  }
  Warn({Sim3Warning(report.sim3, report.ate.rmse)});
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
