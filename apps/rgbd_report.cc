// The page of a run or of a batch from its files.

#include <gflags/gflags.h>

#include <cstdio>
#include <string>

#include "apps/program.h"
#include "apps/report_page.h"
#include "core/input_error.h"

DEFINE_string(run, "", "folder that rgbd_odometry has written its results to");
DEFINE_string(batch, "",
              "folder that rgbd_batch has written its summary.csv to; instead "
              "of --run");

namespace rgbd_pose {
namespace {

ProgramInfo Info() {
  ProgramInfo info;
  info.name = "rgbd_report";
  info.summary = "writes report.html, a page to look at in a browser.";
  info.example = "rgbd_report --run=runs/fr1_xyz";
  info.flag_groups = {{"Input", {"run", "batch"}}};
  return info;
}

int Main() {
  if (FLAGS_batch.empty()) RequireFlag("run", FLAGS_run);
  if (!FLAGS_batch.empty() && !FLAGS_run.empty()) {
    throw InputError("either --run or --batch");
  }
  if (!HasReportLibrary()) {
    throw InputError(
        "built without plotly.js, which pages need; scripts/"
        "install_dependencies fetches it, then configure and build again");
  }
  std::printf("report in   %s\n",
              (FLAGS_run.empty() ? WriteBatchReport(FLAGS_batch)
                                 : WriteRunReport(FLAGS_run))
                  .c_str());
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
