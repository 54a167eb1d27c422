#include "apps/results/frame_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

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

// A lost frame has a pose as well, given by the policy for lost frames.
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
  RelativePose edge;
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

TEST(FrameTablesTest, EdgesAreReadBackToTheirFrames) {
  std::vector<TrackedFrame> frames(3);
  frames[1].status = TrackingStatus::kOk;
  frames[2].status = TrackingStatus::kDegraded;
  frames[2].timestamp = 0.25;
  RelativePose edge;
  edge.cur = 2;
  edge.cur_from_ref = Rigid3d({0.5, 0.5, -0.5, 0.5}, {0.25, -0.125, 3.0});
  edge.covariance(1, 4) = edge.covariance(4, 1) = 2e-7;
  frames[2].edges = {edge, edge};
  frames[2].edges[1].ref = 1;
  const TempFolder folder;
  const std::filesystem::path path = folder.path();
  WriteFileAtomically((path / "frames.csv").string(), FormatFramesCsv(frames));
  WriteFileAtomically((path / "edges.csv").string(), FormatEdgesCsv(frames));
  const std::vector<TrackedFrame> read = ReadFrames(path);
  ASSERT_EQ(read.size(), 3u);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(read[i].status, frames[i].status);
  EXPECT_EQ(read[2].timestamp, 0.25);
  ASSERT_EQ(read[2].edges.size(), 2u);
  EXPECT_EQ(read[2].edges[1].ref, 1);
  EXPECT_EQ(read[2].edges[0].cur_from_ref.translation,
            edge.cur_from_ref.translation);
  EXPECT_EQ(read[2].edges[0].covariance, edge.covariance);
  frames.pop_back();
  WriteFileAtomically((path / "frames.csv").string(), FormatFramesCsv(frames));
  ExpectInputError([&] { ReadFrames(path); }, {"the motion from 0 to 2"});
}

}  // namespace
}  // namespace rgbd_pose
