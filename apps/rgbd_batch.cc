// Runs rgbd_odometry on many sequences with many settings and makes a table.

#include <gflags/gflags.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/batch/batch_runs.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/tracker_factory.h"
#include "robust/m_estimator.h"

DEFINE_string(sequences, "",
              "file with one sequence per line: a folder (or pattern), "
              "optionally followed by a camera (preset or YAML file; default: "
              "camera.yaml in the folder)");
DEFINE_string(costs, rgbd_pose::kDefaultCost,
              "costs, separated by commas; a+b adds costs");
DEFINE_string(
    losses, "tukey",
    "M-estimators, separated by commas, optionally with widths: huber(1.5)");
DEFINE_string(frontends, "patch", "frontends, separated by commas");
DEFINE_string(trackers, "hybrid", "trackers, separated by commas");
DEFINE_string(
    parts, "",
    "parts of each sequence in the format of --frames, separated by commas: "
    "0-,3-,7- (different starts) or 0-299,300-599; each is a run, and the "
    "table has their median and range; empty: the whole sequence");
DEFINE_int32(repeats, 1,
             "runs of each combination; only times differ between them");
DEFINE_string(
    settings, "",
    "flag file for all runs of the program; paths of inputs in it must be "
    "absolute; empty: default settings");
DEFINE_string(output, "", "folder for the results, created if missing");
DEFINE_bool(
    resume, false,
    "run only what is missing, failed, or had other settings or inputs");
DEFINE_bool(merge, false, "run nothing, only write the summary of all shards");
DEFINE_bool(dry_run, false, "run nothing, only print the plan");
DEFINE_int32(jobs, 0, "number of parallel runs; 0: one for each core");
DEFINE_double(timeout, 0.0, "seconds after which a run is killed; 0: never");
DEFINE_string(shard, "",
              "i/n: only every n-th sequence, starting with sequence i (from "
              "0); empty: from the Slurm job array, if any, else all");
DEFINE_string(program, "",
              "program for each run: the name of one in the same folder "
              "(rgbd_slam) or a path; empty: rgbd_odometry");

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

ProgramInfo Info() {
  return {
      "rgbd_batch",
      "runs rgbd_odometry or rgbd_slam on many sequences with many settings, "
      "each run in its own process and folder, and writes one table of the "
      "results.",
      "rgbd_batch --sequences=list.txt --losses=huber,tukey --parts=0-,3-,7- "
      "--output=runs",
      {{"Plan",
        {"sequences", "costs", "losses", "frontends", "trackers", "parts",
         "repeats", "settings"}},
       {"How it is run",
        {"jobs", "timeout", "resume", "shard", "merge", "dry_run", "program"}},
       {"Output", {"output"}}},
      /*settings=*/{},
      {{"costs", CostNames()},
       {"losses", MEstimatorNames()},
       {"frontends", FrontendNames()},
       {"trackers", TrackerNames()}}};
}

std::string ProgramPath() {
  std::error_code error;
  const fs::path beside =
      fs::read_symlink("/proc/self/exe", error).parent_path() /
      (FLAGS_program.empty() ? "rgbd_odometry" : FLAGS_program);
  const bool is_beside =
      FLAGS_program.find('/') == std::string::npos && IsFile(beside);
  const fs::path path =
      is_beside || FLAGS_program.empty() ? beside : fs::absolute(FLAGS_program);
  if (!IsFile(path) || access(path.c_str(), X_OK) != 0) {
    throw InputError(path.string() +
                     ": not an executable program; give one with --program");
  }
  return path.string();
}

void CheckFlags() {
  RequireFlag("sequences", FLAGS_sequences);
  RequireFlag("output", FLAGS_output);
  if (FLAGS_jobs < 0) {
    throw InputError("--jobs must be 0 (one per core) or more");
  }
  if (!(FLAGS_timeout >= 0.0)) {
    throw InputError("--timeout must be 0 (none) or a number of seconds");
  }
  if (FLAGS_merge && (!FLAGS_shard.empty() || FLAGS_resume)) {
    throw InputError("--merge cannot be combined with --shard or --resume");
  }
}

// Why a flag cannot be the same in all runs; empty: it can.
std::string WhyNotForAll(const std::string& flag, const std::string& value) {
  // The values of the lists would replace those of the file in each run.
  for (const auto& [list, name, column, check] : BatchSettings()) {
    if (flag != name) continue;
    return std::string(" cannot be set for all runs; use --") + list;
  }
  if (flag == "dataset" || flag == "output") {
    return " cannot be set for all runs; each has its own";
  }
  const bool is_result =
      flag == "save_cloud" || flag == "save_mesh" || flag == "save_map";
  if (is_result && fs::path(value).is_absolute()) {
    return ": each run would replace that of the run before; give a relative "
           "path, which is in the folder of each run";
  }
  return "";
}

void CheckSettings() {
  for (const TextLine& line : ReadTextTable(FLAGS_settings)) {
    const std::string& word = line.words[0];
    const size_t begin = word.find_first_not_of('-');  // gflags takes -loss too
    if (begin == word.npos) continue;
    const size_t end = word.find('=', begin);
    const std::string flag = word.substr(begin, end - begin);
    const std::string why = WhyNotForAll(
        flag, end == word.npos ? std::string() : word.substr(end + 1));
    if (why.empty()) continue;
    throw InputError(FLAGS_settings, line.number, "--" + flag + why);
  }
}

bool IsToDo(const BatchRun& run, const BatchFolder& folder) {
  const std::optional<RunEnd> end = folder.ReadEnd(run);
  return !end || end->status != "ok";
}

int PrintPlan(const std::vector<BatchRun>& plan, const BatchFolder& folder) {
  int to_do = 0;
  for (const BatchRun& run : plan) {
    const bool is_to_do = IsToDo(run, folder);
    to_do += is_to_do;
    std::printf("%s  %s\n", is_to_do ? "run " : "done", run.Name().c_str());
  }
  std::printf("%zu runs, %d of them to do\n", plan.size(), to_do);
  return kExitOk;
}

// Prevents accidental mixing with the results of another plan.
void RefuseEarlierRuns(const std::vector<BatchRun>& plan,
                       const BatchFolder& folder, const BatchShard& shard) {
  std::string found = shard.IsWhole() ? folder.FindRun("") : "";
  for (size_t i = 0; i < plan.size() && found.empty(); ++i) {
    found = folder.FindRun(plan[i].sequence.name);
  }
  if (found.empty()) return;
  throw InputError("--output=" + FLAGS_output + " already contains runs (" +
                   found +
                   "); add --resume to continue them or choose another folder");
}

void RunAll(const std::vector<BatchRun>& runs, const BatchFolder& folder,
            const std::string& program) {
  BatchPoolOptions options;
  // There is no page per run by default; --settings may request it. A stopped
  // run must not count as finished: the next call would not repeat it.
  options.command = {program, "--report=false", "--finish_on_signal=false"};
  if (!FLAGS_settings.empty()) {
    options.command.push_back("--flagfile=" +
                              fs::absolute(FLAGS_settings).string());
  }
  options.jobs = FLAGS_jobs > 0 ? FLAGS_jobs : AvailableCores();
  options.timeout_seconds = FLAGS_timeout;
  const int total = static_cast<int>(runs.size());
  ProgressBar bar("running", total);
  int done = 0;
  options.on_end = [&](const BatchRun& run, const RunEnd& end, double seconds) {
    ++done;
    const bool is_ok = end.status == "ok";
    // The progress bar says enough about successful runs.
    if (!bar.visible() || !is_ok) {
      bar.PrintLine(
          Format("[%d/%d] ", done, total) + end.status +
          (is_ok ? "" : Format(" (exit code %d)", end.exit_code)) + "  " +
          run.Name() + "  " + FormatDuration(seconds) + ", " +
          bar.TimeLeft(done) + " left" +
          (is_ok ? "" : "; see " + folder.Complete(run) + "/run.log"));
    }
    bar.Update(done);
  };
  bar.Update(0);
  RunBatch(runs, folder, options);
}

// Warns of results from another plan or other inputs.
void WarnOfOtherHashes(const std::vector<BatchRun>& plan,
                       const BatchFolder& folder) {
  int others = 0;
  for (const BatchRun& run : plan) {
    others += folder.Holds(run) && !folder.ReadEnd(run).has_value();
  }
  if (others == 0) return;
  std::fprintf(stderr,
               "rgbd_batch: %d run(s) have other settings or inputs and count "
               "as missing; --resume repeats them\n",
               others);
}

int WriteSummary(const std::vector<BatchRun>& plan, const BatchFolder& folder,
                 const BatchShard& shard) {
  const BatchSummary summary = Summarise(plan, folder);
  std::string path = folder.output() + "/summary";
  if (shard.IsWhole()) {
    WriteFileAtomically(path + ".json", FormatBatchJson(summary));
  } else {
    path += "-" + shard.Name();
  }
  WriteFileAtomically(path + ".csv", FormatBatchCsv(summary));
  std::fputs(FormatBatchTable(summary).c_str(), stdout);
  int not_ok = 0;
  for (const auto& row : summary) not_ok += row["status"] != "ok";
  std::printf("%zu runs, %d not ok; results in %s\n", summary.size(), not_ok,
              FLAGS_output.c_str());
  return not_ok == 0 ? kExitOk : kExitSomeFailed;
}

int Main() {
  CheckFlags();
  if (!FLAGS_settings.empty()) CheckSettings();
  const BatchGrid grid = ParseGrid(
      {FLAGS_costs, FLAGS_losses, FLAGS_frontends, FLAGS_trackers, FLAGS_parts},
      FLAGS_repeats);
  const BatchShard shard = FLAGS_merge ? BatchShard() : ParseShard(FLAGS_shard);
  const std::string program = ProgramPath();
  const std::string settings =
      "program " + HashProgram(program) + "\n" +
      (FLAGS_settings.empty() ? "" : ReadTextFile(FLAGS_settings));
  const std::vector<BatchSequence> sequences =
      ReadSequenceList(FLAGS_sequences);
  for (const BatchSequence& sequence : sequences) {
    RequireOutside("output", FLAGS_output, sequence.folder);
  }
  const std::vector<BatchRun> plan = MakePlan(sequences, grid, shard, settings);
  const BatchFolder folder(fs::absolute(FLAGS_output).string());
  if (FLAGS_dry_run) return PrintPlan(plan, folder);

  std::error_code error;
  fs::create_directories(folder.output(), error);
  if (error) {
    throw InputError("--output=" + FLAGS_output + ": cannot be created (" +
                     error.message() + ")");
  }
  const BatchLock lock(folder.output(), shard);
  if (FLAGS_merge) {
    WarnOfOtherHashes(plan, folder);
    return WriteSummary(plan, folder, shard);
  }
  if (!FLAGS_resume) RefuseEarlierRuns(plan, folder, shard);
  std::vector<BatchRun> to_do;
  for (const BatchRun& run : plan) {
    if (IsToDo(run, folder)) to_do.push_back(run);
  }
  RunAll(to_do, folder, program);
  return WriteSummary(plan, folder, shard);
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
