#include "apps/results/frame_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace rgbd_pose {
namespace {

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream words(line);
  for (std::string cell; std::getline(words, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

// A lost frame, too: its pose is what the policy for lost frames says.
TEST(FrameTablesTest, EveryFrameHasAPose) {
  TrackedFrame frame;
  frame.status = TrackingStatus::kLost;
  frame.world_from_cam = Rigid3d({0.5, 0.5, -0.5, 0.5}, {0.25, -0.125, 3.0});
  std::istringstream csv(FormatFramesCsv({frame}));
  std::string header, row;
  std::getline(csv, header);
  std::getline(csv, row);
  const std::vector<std::string> names = Cells(header), cells = Cells(row);
  ASSERT_EQ(cells.size(), names.size());
  EXPECT_EQ(cells[1], "lost");
  const auto tx = std::find(names.begin(), names.end(), "tx") - names.begin();
  ASSERT_LE(tx + 7u, cells.size());
  EXPECT_THAT(
      std::vector<std::string>(cells.begin() + tx, cells.begin() + tx + 7),
      testing::ElementsAre("0.25", "-0.125", "3", "0.5", "-0.5", "0.5", "0.5"));
}

TEST(FrameTablesTest, AnEdgeIsARow) {
  TrackedFrame none, two;
  Edge edge;
  edge.ref = 3;
  edge.cur = 7;
  edge.cur_from_ref = Rigid3d({0.5, 0.5, -0.5, 0.5}, {0.25, -0.125, 1e-5});
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j)
      edge.covariance(i, j) = (i + 1) * (j + 1) * 1e-7;
  }
  two.edges = {edge, edge};
  two.edges[1].ref = 5;
  std::istringstream csv(FormatEdgesCsv({none, two}));
  std::string header, first, second, more;
  std::getline(csv, header);
  std::getline(csv, first);
  std::getline(csv, second);
  EXPECT_FALSE(std::getline(csv, more));
  const std::vector<std::string> names = Cells(header), cells = Cells(first);
  ASSERT_EQ(names.size(), 2u + 7u + 21u);
  ASSERT_EQ(cells.size(), names.size());
  EXPECT_EQ(names[10], "cov_wx_wy");
  EXPECT_EQ(names.back(), "cov_cz_cz");
  EXPECT_THAT(std::vector<std::string>(cells.begin(), cells.begin() + 11),
              testing::ElementsAre("3", "7", "0.25", "-0.125", "1e-05", "0.5",
                                   "-0.5", "0.5", "0.5", "1e-07", "2e-07"));
  EXPECT_EQ(cells.back(), "3.6e-06");
  EXPECT_EQ(second.substr(0, 4), "5,7,");
}

}  // namespace
}  // namespace rgbd_pose
