// The input of a batch's page: summary.csv.

#include <nlohmann/json.hpp>

#include "apps/report/report_data.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(batch_report) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  folder.Write("summary.csv", FuzzText(data, size));
  MayRefuse([&] {
    BatchReportData(folder.path())
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  });
  return 0;
}
