// The files of a finished run that a batch reads: done.json and metrics.json,
// one after the other in the input.

#include <nlohmann/json.hpp>

#include "apps/batch/batch_runs.h"
#include "apps/shell/csv_table.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(batch_folder) {
  using namespace rgbd_pose;
  static const FuzzFolder files;
  static const BatchRun run = {
      {"a", "", ""}, {"b", "c", "d", "e", ""}, 1, "0123"};
  static const BatchFolder folder(files.path());
  std::filesystem::create_directories(folder.Complete(run));
  std::string_view rest = FuzzText(data, size);
  files.Write(run.Name() + "/done.json", NextFile(&rest));
  files.Write(run.Name() + "/metrics.json", NextFile(&rest));
  MayRefuse([&] { folder.ReadEnd(run); });
  MayRefuse([&] {
    const BatchSummary summary = Summarise({run}, folder);
    FormatBatchTable(summary);
    FormatBatchJson(summary);
    const std::string csv = FormatBatchCsv(summary);
    const CsvTable table = CsvTable::Read(files.Write("summary.csv", csv));
    Require(table.size() == 1, "a row a run");
    table.Numbers("ate_rmse_m");
  });
  return 0;
}
