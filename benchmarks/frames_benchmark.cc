// Whole frames, from images to pose, by this project, OpenCV and Open3D: time
// on one core and errors against the ground truth. Writes JSON as Google
// Benchmark does, one entry per round and method; times are medians over the
// frames.
//
// Names: frames/<sequence>/<method>.

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/shell/program.h"
#include "benchmarks/frame_trackers.h"
#include "core/evaluation/evaluation.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/sources/open_source.h"

DEFINE_int32(frames, 90, "frames of each sequence, from its start");
DEFINE_int32(rounds, 5, "how often each method tracks each sequence");
DEFINE_string(path, "xyz", "path through the simulated room; empty: no room");
DEFINE_string(methods, "", "how names of methods begin; empty: all");
DEFINE_string(dataset, "",
              "folder of a sequence in TUM RGB-D layout to track as well");
DEFINE_string(camera, "",
              "YAML file or preset of that sequence; OpenCV's odometries leave "
              "its distortion out");
DEFINE_string(output, "", "JSON file to write");

namespace rgbd_pose {
namespace {

struct Sequence {
  std::string name;
  RgbdCamera camera;
  std::vector<BenchmarkFrame> frames;
  Trajectory truth;
};

// Reads or renders all frames before any clock starts.
Sequence Load(const std::string& name, const Dataset& dataset,
              const Trajectory& truth) {
  Sequence sequence = {name, dataset.camera(), {}, truth};
  const int count = std::min(FLAGS_frames, dataset.size());
  for (int i = 0; i < count; ++i) {
    sequence.frames.emplace_back(dataset.Read(i));
  }
  return sequence;
}

Sequence LoadRoom() {
  SyntheticOptions options;
  options.path = FLAGS_path;
  options.frames = std::max(FLAGS_frames, 150);  // one full round of the path
  const SyntheticDataset dataset(options);
  return Load("room_" + FLAGS_path, dataset, dataset.ground_truth());
}

Sequence LoadFolder() {
  SourceOptions options;
  options.path = FLAGS_dataset;
  options.camera = ResolveCamera(FLAGS_camera);
  const std::filesystem::path folder =
      std::filesystem::absolute(FLAGS_dataset).lexically_normal();
  const std::string name = folder.has_filename()
                               ? folder.filename().string()
                               : folder.parent_path().filename().string();
  return Load(name, *OpenTum(options),
              ReadTrajectory((folder / "groundtruth.txt").string()));
}

// Milliseconds: CPU time of all threads of the process, and wall time.
struct Clock {
  std::clock_t cpu = std::clock();
  std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();

  double CpuMs() const { return 1e3 * (std::clock() - cpu) / CLOCKS_PER_SEC; }
  double WallMs() const {
    return std::chrono::duration<double, std::milli>(
               std::chrono::steady_clock::now() - wall)
        .count();
  }
};

// The first frame is not timed: there is nothing to track it against.
nlohmann::json RunRound(const Sequence& sequence, const FrameTrackerType& type,
                        int round) {
  const std::unique_ptr<FrameTracker> tracker = type.make(sequence.camera);
  std::vector<double> cpu_ms, wall_ms;
  Trajectory trajectory;
  for (const BenchmarkFrame& frame : sequence.frames) {
    const Clock clock;
    const std::optional<Rigid3d> pose = tracker->Track(frame);
    if (&frame != &sequence.frames.front()) {
      cpu_ms.push_back(clock.CpuMs());
      wall_ms.push_back(clock.WallMs());
    }
    if (pose.has_value()) {
      trajectory.push_back({frame.frame.timestamp, *pose});
    }
  }
  const EvaluationReport report = Evaluate(trajectory, sequence.truth);
  nlohmann::json entry = {
      {"name", "frames/" + sequence.name + "/" + type.name},
      {"run_type", "iteration"},
      {"repetition_index", round},
      {"cpu_time", Quantile(cpu_ms, 0.5)},
      {"real_time", Quantile(wall_ms, 0.5)},
      {"time_unit", "ms"},
      {"p99_ms", Quantile(cpu_ms, 0.99)},
      {"frames", sequence.frames.size()},
      {"failed", sequence.frames.size() - trajectory.size()},
      {"ate_m", report.ate.rmse}};
  for (size_t i = 0; i < report.rpe_frames.size(); ++i) {
    const std::string frames = std::to_string(report.options.rpe_frames[i]);
    entry["rpe_" + frames + "_median_m"] =
        report.rpe_frames[i].translation.median;
  }
  if (report.rpe_seconds.translation.count > 0) {
    entry["rpe_m"] = report.rpe_seconds.translation.rmse;
    entry["rpe_deg"] = report.rpe_seconds.rotation.rmse * 180.0 / M_PI;
  }
  return entry;
}

int Main() {
  RequireFlag("output", FLAGS_output);
  if (FLAGS_frames < 2) throw InputError("--frames must be at least 2");
  if (FLAGS_rounds < 1) throw InputError("--rounds must be at least 1");
  if (!FLAGS_dataset.empty()) RequireFlag("camera", FLAGS_camera);
  cv::setNumThreads(1);
  double load[3] = {};
  getloadavg(load, 3);
  std::vector<Sequence> sequences;
  if (!FLAGS_path.empty()) sequences.push_back(LoadRoom());
  if (!FLAGS_dataset.empty()) sequences.push_back(LoadFolder());
  const std::vector<FrameTrackerType> types = FrameTrackerTypes();
  nlohmann::json benchmarks = nlohmann::json::array();
  for (int round = 0; round < FLAGS_rounds; ++round) {
    for (const Sequence& sequence : sequences) {
      for (const FrameTrackerType& type : types) {
        if (type.name.rfind(FLAGS_methods, 0) != 0) continue;
        benchmarks.push_back(RunRound(sequence, type, round));
        std::fprintf(stderr, "%s, round %d of %d\n",
                     benchmarks.back()["name"].get<std::string>().c_str(),
                     round + 1, FLAGS_rounds);
      }
    }
  }
  const nlohmann::json output = {{"context", {{"load_avg", load}}},
                                 {"benchmarks", benchmarks}};
  WriteFileAtomically(FLAGS_output, output.dump(1) + "\n");
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  const rgbd_pose::ProgramInfo info = {
      "frames_benchmark",
      "tracks sequences by this project, OpenCV and Open3D: times and errors",
      "frames_benchmark --frames=90 --rounds=5 --output=frames.json",
      {{"Input", {"frames", "rounds", "path", "methods", "dataset", "camera"}},
       {"Output", {"output"}}},
      /*settings=*/{},
      {{"path", rgbd_pose::SyntheticPathNames()}}};
  return rgbd_pose::RunProgram(argc, argv, info, rgbd_pose::Main);
}
