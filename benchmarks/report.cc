// Converts the outputs of the benchmark programs into docs/benchmarks.md for
// readers and benchmarks.json for programs.

#include <gflags/gflags.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "apps/shell/program.h"
#include "benchmarks/machine.h"
#include "benchmarks/report_tables.h"
#include "benchmarks/results.h"
#include "benchmarks/speedups.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

DEFINE_string(results, "",
              "JSON outputs of the benchmark programs, set apart by commas");
DEFINE_string(machine, "unnamed", "what to call this machine");
DEFINE_string(page_template, "", "Markdown with @NAMES@ to fill in");
DEFINE_string(page, "", "Markdown file to write");
DEFINE_string(speedups, "", "JSON file of speed-up ratios to write");

namespace rgbd_pose {
namespace {

// Table rows end in a line break that the template has as well.
std::string WithoutLastBreak(std::string text) {
  if (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string FillIn(std::string page,
                   const std::map<std::string, std::string>& values) {
  for (const auto& [name, value] : values) {
    const std::string mark = "@" + name + "@";
    const size_t place = page.find(mark);
    if (place == std::string::npos) {
      throw InputError(FLAGS_page_template + ": has no " + mark);
    }
    page.replace(place, mark.size(), WithoutLastBreak(value));
  }
  return page;
}

int Main() {
  RequireFlag("results", FLAGS_results);
  RequireFlag("page_template", FLAGS_page_template);
  RequireFlag("page", FLAGS_page);
  RequireFlag("speedups", FLAGS_speedups);
  double load_after[1] = {};
  getloadavg(load_after, 1);

  BenchmarkResults results;
  std::istringstream paths(FLAGS_results);
  for (std::string path; std::getline(paths, path, ',');) results.Read(path);
  if (results.benchmarks.empty()) {
    throw InputError("--results=" + FLAGS_results + ": nothing was measured");
  }
  const std::vector<SpeedupRow> speedups = FindSpeedups(results);
  auto values = ReportTables(results, speedups, load_after[0]);
  values["MACHINE"] = DescribeMachine(FLAGS_machine);
  WriteFileAtomically(FLAGS_page,
                      FillIn(ReadTextFile(FLAGS_page_template), values));
  nlohmann::json ratios = nlohmann::json::object();
  for (const SpeedupRow& row : speedups) ratios[row.key] = row.speedup;
  WriteFileAtomically(FLAGS_speedups, ratios.dump(2) + "\n");
  std::printf("tables in    %s\nspeed-ups in %s\n", FLAGS_page.c_str(),
              FLAGS_speedups.c_str());
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  const rgbd_pose::ProgramInfo info = {
      "benchmark_report",
      "makes a page of tables of what the benchmark programs have measured",
      "benchmark_report --results=solve.json,jacobian.json "
      "--page_template=benchmarks/benchmarks.md.in --page=docs/benchmarks.md "
      "--speedups=build/benchmarks.json",
      {{"Input", {"results", "page_template", "machine"}},
       {"Output", {"page", "speedups"}}}};
  return rgbd_pose::RunProgram(argc, argv, info, rgbd_pose::Main);
}
