#include "apps/results/frame_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/shell/csv_table.h"
#include "core/util/text_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using testing::ElementsAre;
using testing::IsNan;

constexpr const char* kPoseColumns[] = {"tx", "ty", "tz", "qx",
                                        "qy", "qz", "qw"};

// A lost frame has a pose as well, given by the policy for lost frames.
TEST(FrameTablesTest, EveryFrameHasAPose) {
  TrackedFrame frame;
  frame.status = TrackingStatus::kLost;
  frame.world_from_cam = Rigid3d({0.5, 0.5, -0.5, 0.5}, {0.25, -0.125, 3.0});
  const TempFolder folder;
  const CsvTable table =
      CsvTable::Read(folder.Write("frames.csv", FormatFramesCsv({frame})));
  EXPECT_THAT(table.Words("status"), ElementsAre("lost"));
  const double pose[] = {0.25, -0.125, 3.0, 0.5, -0.5, 0.5, 0.5};
  for (int k = 0; k < 7; ++k) {
    EXPECT_THAT(table.Numbers(kPoseColumns[k]), ElementsAre(pose[k]));
  }
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
  const TempFolder folder;
  const std::string csv = FormatEdgesCsv({none, two});
  EXPECT_EQ(std::count(csv.begin(), csv.begin() + csv.find('\n'), ','),
            2 + 7 + 21 - 1);
  const CsvTable table = CsvTable::Read(folder.Write("edges.csv", csv));
  EXPECT_THAT(table.Words("ref"), ElementsAre("3", "5"));
  EXPECT_THAT(table.Words("cur"), ElementsAre("7", "7"));
  const char* pose[] = {"0.25", "-0.125", "1e-05", "0.5", "-0.5", "0.5", "0.5"};
  for (int k = 0; k < 7; ++k) {
    EXPECT_EQ(table.Words(kPoseColumns[k])[0], pose[k]);
  }
  EXPECT_EQ(table.Words("cov_wx_wx")[0], "1e-07");
  EXPECT_EQ(table.Words("cov_wx_wy")[0], "2e-07");
  EXPECT_EQ(table.Words("cov_cz_cz")[0], "3.6e-06");
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

// In a run with a loaded map, frames are tracked against its keyframes as well.
TEST(FrameTablesTest, MotionsSinceKeyframesOfALoadedMapAreReadBack) {
  std::vector<TrackedFrame> frames(2);
  RelativePose edge;
  edge.ref = -86;
  edge.cur = 1;
  frames[1].edges = {edge};
  const TempFolder folder;
  const std::filesystem::path path = folder.path();
  WriteFileAtomically((path / "frames.csv").string(), FormatFramesCsv(frames));
  WriteFileAtomically((path / "edges.csv").string(), FormatEdgesCsv(frames));
  const std::vector<TrackedFrame> read = ReadFrames(path);
  ASSERT_EQ(read[1].edges.size(), 1u);
  EXPECT_EQ(read[1].edges[0].ref, -86);
}

// A camera that moves along x, 0.5 m per frame, at two frames per second. The
// truth has no pose for the last frame, and the second frame is lost.
TEST(FrameErrors, OneRowAFrameWithGapsWhereNothingIsKnown) {
  Trajectory truth, estimate;
  std::vector<TrackedFrame> frames(5);
  for (int i = 0; i < 5; ++i) {
    const Rigid3d pose({1, 0, 0, 0}, {0.5 * i, 0, 0});
    frames[i].timestamp = 0.5 * i;
    // As known while tracking; the path was corrected later.
    frames[i].world_from_cam.translation.x() = 0.4 * i;
    frames[i].status = i == 1 ? TrackingStatus::kLost : TrackingStatus::kOk;
    if (i < 4) {
      truth.push_back({0.5 * i, Rigid3d({1, 0, 0, 0}, {0.5 * i, 0, 7})});
    }
    if (i != 1) estimate.push_back({0.5 * i, pose});
  }
  const TempFolder folder;
  const CsvTable table = CsvTable::Read(folder.Write(
      "errors.csv",
      FormatErrorsCsv(frames, estimate, truth, Evaluate(estimate, truth))));
  EXPECT_THAT(table.Numbers("timestamp"), ElementsAre(0, 0.5, 1, 1.5, 2));
  EXPECT_THAT(table.Numbers("true_x"), ElementsAre(0, 0.5, 1, 1.5, IsNan()));
  EXPECT_THAT(table.Numbers("x"), ElementsAre(0, IsNan(), 1, 1.5, 2));
  EXPECT_THAT(table.Numbers("z"), ElementsAre(7, IsNan(), 7, 7, 7));
  EXPECT_THAT(table.Numbers("position_error_m"),
              ElementsAre(0, IsNan(), 0, 0, IsNan()));
  // Only the first frame has a counterpart 1 s later.
  EXPECT_THAT(table.Numbers("rpe_m"),
              ElementsAre(0, IsNan(), IsNan(), IsNan(), IsNan()));
}

}  // namespace
}  // namespace rgbd_pose
