// Compares the pages on costs and on losses with the lists of both.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

struct Entry {
  std::string rows;
  std::string degrees_of_freedom;
};

// The cells of a table's line "| a | b | c |"; empty for any other line.
std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  if (line.empty() || line[0] != '|') return cells;
  std::istringstream stream(line.substr(1));
  std::string cell;
  while (std::getline(stream, cell, '|')) {
    const size_t first = cell.find_first_not_of(' ');
    const size_t last = cell.find_last_not_of(' ');
    cells.push_back(
        first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

// The lines "| `name` | rows | independent rows |" of the page on costs, and
// the sections "## `name`" of that on their formulas.
class CostsDocumentTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Read(RGBD_POSE_DOCS_DIR "/costs.md");
    Read(RGBD_POSE_DOCS_DIR "/reference/cost_formulas.md");
  }

  void Read(const std::string& path) {
    std::ifstream file(path);
    ASSERT_TRUE(file.is_open()) << path;
    std::string line;
    while (std::getline(file, line)) {
      if (line.rfind("## `", 0) == 0) {
        ++sections_[line.substr(4, line.rfind('`') - 4)];
      }
      const std::vector<std::string> cells = Cells(line);
      if (cells.size() < 3 || cells[0].size() < 3 || cells[0][0] != '`') {
        continue;
      }
      const std::string name = cells[0].substr(1, cells[0].size() - 2);
      EXPECT_EQ(table_.count(name), 0u) << name << " twice";
      table_[name] = {cells[1], cells[2]};
    }
  }

  std::map<std::string, Entry> table_;
  std::map<std::string, int> sections_;
};

// A cost over matches or over images.
std::unique_ptr<MotionCost> MakeAnyCost(const std::string& name) {
  std::unique_ptr<MotionCost> cost = MakeCost(name);
  return cost != nullptr ? std::move(cost) : MakeDirectCost(name, {});
}

std::vector<std::string> AllCostNames() {
  std::vector<std::string> names = CostNames();
  for (const std::string& name : DirectCostNames()) names.push_back(name);
  return names;
}

TEST_F(CostsDocumentTest, HasEveryCostWithItsRows) {
  for (const std::string& name : AllCostNames()) {
    EXPECT_EQ(sections_[name], 1)
        << "docs/reference/cost_formulas.md has no section on " << name;
    ASSERT_TRUE(table_.count(name))
        << name << " is missing in the table of docs/costs.md";
    const std::unique_ptr<MotionCost> cost = MakeAnyCost(name);
    EXPECT_EQ(table_[name].rows, std::to_string(cost->num_residuals())) << name;
    EXPECT_EQ(table_[name].degrees_of_freedom,
              std::to_string(cost->degrees_of_freedom()))
        << name;
  }
}

TEST_F(CostsDocumentTest, HasNoCostThatIsNone) {
  for (const auto& [name, entry] : table_) {
    EXPECT_NE(MakeAnyCost(name), nullptr) << name << " in the table";
  }
  for (const auto& [name, count] : sections_) {
    EXPECT_NE(MakeAnyCost(name), nullptr) << name;
  }
}

std::string Printed(double width) {
  char text[16];
  std::snprintf(text, sizeof(text), "%.4f", width);
  return text;
}

// Whether the influence w(x) x of a residual of 10^6 widths is at most 1e-4 of
// the largest: 1 / x falls to 2e-6, a constant not at all.
bool IsRedescending(const MEstimator& row) {
  if (row.make == nullptr) return false;
  const std::unique_ptr<ceres::LossFunction> loss = row.make(1.0);
  double largest = 0.0, last = 0.0;
  for (double x = 1e-3; x < 1e6; x *= 1.1) {
    double rho[3];
    loss->Evaluate(x * x, rho);
    last = rho[1] * x;
    largest = std::max(largest, last);
  }
  return last < 1e-4 * largest;
}

// The lines "| `name` | weight | width, 1 | width, 3 | redescending |".
TEST(LossesDocumentTest, HasEveryLossAsItIs) {
  std::ifstream file(RGBD_POSE_DOCS_DIR "/losses.md");
  ASSERT_TRUE(file.is_open());
  std::vector<std::vector<std::string>> table;
  std::string line;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = Cells(line);
    if (!cells.empty() && cells[0][0] == '`' && cells[0].back() == '`' &&
        cells[0][1] != '-') {
      table.push_back(cells);
    }
  }
  std::vector<std::vector<std::string>> expected;
  std::string lines;
  for (const MEstimator& row : MEstimators()) {
    const bool is_tuned = row.Width95(1) != 1.0;
    expected.push_back({"`" + std::string(row.name) + "`",
                        std::string(row.formula),
                        is_tuned ? Printed(row.Width95(1)) : "",
                        is_tuned ? Printed(row.Width95(3)) : "",
                        IsRedescending(row) ? "yes" : "no"});
    for (const std::string& cell : expected.back()) lines += "| " + cell + " ";
    lines += "|\n";
  }
  EXPECT_TRUE(table == expected) << "the table of docs/losses.md has to be\n"
                                 << lines;
}

}  // namespace
}  // namespace rgbd_pose
