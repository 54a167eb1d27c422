#include "apps/shell/csv_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using testing::ElementsAre;

TEST(CsvTable, CellsMayBeQuotedOrEmpty) {
  const TempFolder folder;
  folder.Write("table.csv", "a,b,c\n1.5,\"x, y\",\n-2,\"\",3\n");
  const CsvTable table = CsvTable::Read(folder / "table.csv");
  EXPECT_EQ(table.size(), 2u);
  EXPECT_THAT(table.Words("b"), ElementsAre("x, y", ""));
  EXPECT_THAT(table.Numbers("a"), ElementsAre(1.5, -2.0));
  EXPECT_TRUE(std::isnan(table.Numbers("c")[0]));
  EXPECT_EQ(table.Numbers("c")[1], 3.0);
}

TEST(CsvTable, BadTablesNameTheLine) {
  const TempFolder folder;
  folder.Write("short.csv", "a,b\n1,2\n3\n");
  ExpectInputError([&] { CsvTable::Read(folder / "short.csv"); },
                   {"short.csv:3: 1 cells"});
  folder.Write("word.csv", "a,b\n1,2\n3,four\n");
  const CsvTable table = CsvTable::Read(folder / "word.csv");
  ExpectInputError([&] { table.Numbers("b"); }, {"word.csv:3"});
  ExpectInputError([&] { table.Words("c"); }, {"no column 'c'"});
}

}  // namespace
}  // namespace rgbd_pose
