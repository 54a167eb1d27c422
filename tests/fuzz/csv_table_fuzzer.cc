// Tables read by the reports.

#include "apps/shell/csv_table.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(csv_table) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("table.csv", FuzzText(data, size));
  MayRefuse([&] {
    const CsvTable table = CsvTable::Read(file);
    Require(table.Words("a").size() == table.size(), "a cell a row");
    Require(table.Numbers("a").size() == table.size(), "a cell a row");
  });
  return 0;
}
