// The input of a run's page: frames.csv, metrics.json, config.flags,
// trajectory.txt and optionally errors.csv, one after the other.

#include <nlohmann/json.hpp>

#include "apps/report/report_data.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(run_report) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  std::string_view rest = FuzzText(data, size);
  for (const char* name :
       {"frames.csv", "metrics.json", "config.flags", "trajectory.txt"}) {
    folder.Write(name, NextFile(&rest));
  }
  std::filesystem::remove(folder.path() + "/errors.csv");
  if (!rest.empty()) folder.Write("errors.csv", rest);
  MayRefuse([&] {
    RunReportData(folder.path())
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  });
  return 0;
}
