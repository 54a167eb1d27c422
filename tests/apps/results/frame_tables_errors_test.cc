#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/results/frame_tables.h"
#include "apps/shell/csv_table.h"
#include "core/util/text_file.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using testing::ElementsAre;
using testing::IsNan;

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
