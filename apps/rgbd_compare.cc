// The thesis' fourth chapter: M-estimators compared on a camera that returns
// to its start, on one that moves along its axes, and on wrong matches.

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <sstream>
#include <system_error>

#include "apps/compare/compare_paths.h"
#include "apps/compare/compare_sequence.h"
#include "apps/compare/compare_sequence_report.h"
#include "apps/compare/compare_sweep.h"
#include "apps/compare/compare_sweep_report.h"
#include "apps/compare/compare_sweep_verdict.h"
#include "apps/report/report_page.h"
#include "apps/shell/available_cores.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/sources/camera_file.h"
#include "frontend/sources/open_source.h"
#include "robust/m_estimator.h"

DEFINE_string(
    experiment, "",
    "pan_tilt or xyz (simulated), sweep (wrong matches), or the "
    "folder of a sequence in TUM RGB-D layout, best with groundtruth.txt");
DEFINE_string(losses, "",
              "M-estimators, separated by commas; empty: all in a sweep, else "
              "none,huber,cauchy,geman_mcclure,welsch,tukey");
DEFINE_string(cost, "bidirectional_point", "cost of a match");
DEFINE_string(camera, "",
              "YAML file or preset; empty: ros_default where simulated");
DEFINE_string(frontend, "patch", "where matches of images come from");
DEFINE_int32(frames, 150, "frames of a simulated sequence");
DEFINE_int32(seeds, 200, "trials of a sweep at each share of wrong matches");
DEFINE_bool(report, true, "write OUTPUT/report.html, to look at in a browser");
DEFINE_string(output, "", "folder for the results, made if missing");

namespace rgbd_pose {
namespace {

constexpr char kSequenceLosses[] =
    "none,huber,cauchy,geman_mcclure,welsch,tukey";
// ORB-SLAM2 uses it on freiburg2, whose depths it found 4 % too great.
constexpr double kOtherFr2DepthScale = 5208.0;
constexpr int kMaxSeeds = 100000;
// A sequence of which less was tracked, whatever the loss, compares nothing.
constexpr double kMinTrackedShare = 0.5;

ProgramInfo Info() {
  ProgramInfo info;
  info.name = "rgbd_compare";
  info.summary = "compares M-estimators as the thesis' fourth chapter does.";
  info.example = "rgbd_compare --experiment=xyz --output=compare/xyz";
  info.flag_groups = {{"Experiment",
                       {"experiment", "losses", "cost", "camera", "frontend",
                        "frames", "seeds"}},
                      {"Output", {"output", "report"}}};
  info.choices = {{"losses", MEstimatorNames()},
                  {"cost", CostNames()},
                  {"camera", CameraPresetNames()},
                  {"frontend", FrontendNames()}};
  return info;
}

std::vector<std::string> Losses() {
  std::string text = FLAGS_losses;
  if (text.empty() && FLAGS_experiment == "sweep") return MEstimatorNames();
  if (text.empty()) text = kSequenceLosses;
  std::vector<std::string> losses;
  std::istringstream words(text);
  for (std::string loss; std::getline(words, loss, ',');) {
    if (FindMEstimator(loss) == nullptr) {
      throw InputError("--losses: unknown loss '" + loss + "'; there are " +
                       Join(MEstimatorNames()));
    }
    if (std::find(losses.begin(), losses.end(), loss) != losses.end()) {
      throw InputError("--losses: '" + loss + "' is there twice");
    }
    losses.push_back(loss);
  }
  if (losses.empty()) throw InputError("--losses holds no names");
  return losses;
}

// The last name of a path, which may end with a slash; as a word of a table.
std::string FolderName(const std::string& path) {
  const std::filesystem::path folder =
      std::filesystem::absolute(path).lexically_normal();
  std::string name =
      (folder.has_filename() ? folder : folder.parent_path()).filename();
  std::replace(name.begin(), name.end(), '"', '\'');
  return name;
}

constexpr char kReport[] = "report.md";

std::filesystem::path Output(const std::string& file) {
  return std::filesystem::path(FLAGS_output) / file;
}

// Whether results can be written is better known before the work.
void PrepareOutput() {
  std::error_code error;
  std::filesystem::create_directories(FLAGS_output, error);
  if (error) {
    throw InputError("--output=" + FLAGS_output + ": cannot be made (" +
                     error.message() + ")");
  }
  RequireWritable(Output(kReport).string());
}

// The report is the last to be written and the first of an earlier one to go:
// where it is, all is of one run.
void Write(const std::string& file, const std::string& content) {
  std::error_code ignored;
  std::filesystem::remove(Output(kReport), ignored);
  WriteFileAtomically(Output(file).string(), content);
}

// Writes and prints what every experiment ends with.
void Finish(const std::string& report) {
  Write("config.flags", FormatFlagFile(Info()));
  Write(kReport, report);
  std::printf("%s", report.c_str());
  if (!FLAGS_report) return;
  std::printf("report in   %s\n",
              HasReportLibrary() ? WriteComparisonReport(FLAGS_output).c_str()
                                 : kNoReportLibrary);
}

// What is known of several sequences, one after the other.
struct SequenceResults {
  std::string report;  // report.md
  std::string tables = kSequenceCsvHeader;
  std::string paths = kComparedPathsCsvHeader;
  bool any_tracked = false;  // some loss, in some sequence
};

void AddSequence(const std::string& title, const std::string& figure,
                 FrameSource* source, const std::optional<Trajectory>& truth,
                 bool returns_to_start, SequenceResults* results) {
  OdometrySettings settings;
  settings.estimator.cost = FLAGS_cost;
  settings.frontend = FLAGS_frontend;
  PrepareOutput();
  const std::vector<LossRun> runs =
      CompareLosses(source, truth, Losses(), settings, AvailableCores());
  results->report += "## " + title + "\n\n";
  if (returns_to_start) {
    results->report +=
        "End pose against angle [0 0 0] and translation [0 0 0], as in "
        "the thesis' Tables 4.4-4.6:\n\n" +
        EndPoseTable(runs, returns_to_start) + "\n";
  }
  if (truth.has_value()) {
    results->report +=
        "Errors along the path (RMSE), as in the thesis' Tables 4.7 and "
        "4.8:\n\n" +
        PathErrorTable(runs);
  } else {
    results->report +=
        "There is no groundtruth.txt, so errors are not known. The last pose "
        "seen from the first:\n\n" +
        EndPoseTable(runs, returns_to_start) + "\n" + TrackedLine(runs);
  }
  results->report += "\n![Top views of the paths](" + figure + ")\n\n";
  results->tables += SequenceCsvRows(title, runs);
  const std::vector<ComparedPath> paths = ComparePaths(runs, truth);
  results->paths += ComparedPathsCsvRows(title, paths);
  Write(figure, PathFigure(title, paths));
  for (const LossRun& run : runs) {
    results->any_tracked |= run.TrackedShare() >= kMinTrackedShare;
  }
}

void AddSimulated(SequenceResults* results) {
  SyntheticOptions options;
  options.path = FLAGS_experiment;
  options.frames = FLAGS_frames;
  options.camera =
      ResolveCamera(FLAGS_camera.empty() ? "ros_default" : FLAGS_camera);
  SyntheticDataset dataset(options);
  AddSequence("simulated " + FLAGS_experiment + ", " +
                  std::to_string(FLAGS_frames) + " frames",
              "paths.svg", &dataset, dataset.ground_truth(),
              FLAGS_experiment == "pan_tilt", results);
}

// The sequence of a folder, once for each depth scale it may have.
void AddRecorded(const std::string& name, SequenceResults* results) {
  RequireFlag("camera", FLAGS_camera);
  const std::string truth_file =
      (std::filesystem::path(FLAGS_experiment) / "groundtruth.txt").string();
  std::optional<Trajectory> truth;
  if (std::filesystem::exists(truth_file)) truth = ReadTrajectory(truth_file);
  SourceOptions options;
  options.path = FLAGS_experiment;
  options.camera = ResolveCamera(FLAGS_camera);
  std::vector<double> scales = {options.camera.depth_scale};
  if (FLAGS_camera == "tum_fr2") scales.push_back(kOtherFr2DepthScale);
  for (const double scale : scales) {
    options.camera.depth_scale = scale;
    const std::unique_ptr<FrameSource> source = OpenSource("auto", options);
    char units[32];
    std::snprintf(units, sizeof(units), "%.10g", scale);
    AddSequence(name + ", " + units + " raw depth units per metre",
                scales.size() == 1 ? "paths.svg"
                                   : std::string("paths_") + units + ".svg",
                source.get(), truth, /*returns_to_start=*/false, results);
  }
}

int CompareSequences() {
  const bool simulated =
      FLAGS_experiment == "pan_tilt" || FLAGS_experiment == "xyz";
  std::error_code error;
  if (!simulated && !std::filesystem::is_directory(FLAGS_experiment, error)) {
    throw InputError("--experiment=" + FLAGS_experiment +
                     " is neither pan_tilt, xyz or sweep nor a folder");
  }
  const std::string name =
      simulated ? FLAGS_experiment : FolderName(FLAGS_experiment);
  SequenceResults results;
  results.report = "# M-estimators on " + name + "\n\n";
  if (simulated) {
    AddSimulated(&results);
  } else {
    AddRecorded(name, &results);
  }
  Write("tables.csv", results.tables);
  Write("paths.csv", results.paths);
  Finish(results.report);
  return results.any_tracked ? kExitOk : kExitTrackingFailed;
}

int Sweep() {
  SweepOptions options;
  options.losses = Losses();
  options.cost = FLAGS_cost;
  options.seeds = FLAGS_seeds;
  options.threads = AvailableCores();
  if (FLAGS_seeds < 1 || FLAGS_seeds > kMaxSeeds) {
    throw InputError("--seeds must be 1 to " + std::to_string(kMaxSeeds));
  }
  PrepareOutput();
  const std::vector<SweepCell> cells = RunSweep(options);
  const std::string report =
      "# M-estimators on wrong matches\n\n" + SweepVerdict(cells) +
      "\n\nMedian translation errors (mm) and their 95 % bands over " +
      std::to_string(FLAGS_seeds) + " trials of " +
      std::to_string(options.matches) +
      " matches with Kinect noise;\ngraduated losses that start from no "
      "motion:\n\n" +
      SweepTable(cells) +
      "\n![Translation errors](translation.svg)\n"
      "![Rotation errors](rotation.svg)\n";
  Write("sweep.csv", SweepCsv(cells));
  Write("translation.svg", SweepFigure(cells, /*rotation=*/false));
  Write("rotation.svg", SweepFigure(cells, /*rotation=*/true));
  Finish(report);
  return kExitOk;
}

int Main() {
  RequireFlag("experiment", FLAGS_experiment);
  RequireFlag("output", FLAGS_output);
  cv::setNumThreads(1);  // the threads are ours
  return FLAGS_experiment == "sweep" ? Sweep() : CompareSequences();
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
