// Makes the page of a run, a batch or a comparison from its files.

#include <gflags/gflags.h>

#include <cstdio>
#include <string>

#include "apps/report/report_page.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"

DEFINE_string(run, "", "results folder of rgbd_odometry");
DEFINE_string(
    batch, "",
    "results folder of rgbd_batch (with summary.csv); instead of --run");
DEFINE_string(comparison, "",
              "results folder of rgbd_compare; instead of --run");

namespace rgbd_pose {
namespace {

ProgramInfo Info() {
  return {"rgbd_report",
          "writes report.html, a page with the plots of a run, a batch or a "
          "comparison.",
          "rgbd_report --run=runs/fr1_xyz",
          {{"Input", {"run", "batch", "comparison"}}}};
}

int Main() {
  const int given =
      !FLAGS_run.empty() + !FLAGS_batch.empty() + !FLAGS_comparison.empty();
  if (given == 0) RequireFlag("run", FLAGS_run);
  if (given > 1) {
    throw InputError("give only one of --run, --batch and --comparison");
  }
  if (!HasReportLibrary()) {
    throw InputError(
        "built without plotly.js, which pages need; run "
        "scripts/install_dependencies, then configure and build again");
  }
  const std::string path =
      !FLAGS_batch.empty()        ? WriteReport("batch", FLAGS_batch)
      : !FLAGS_comparison.empty() ? WriteReport("comparison", FLAGS_comparison)
                                  : WriteReport("run", FLAGS_run);
  std::printf("report in   %s\n", path.c_str());
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
