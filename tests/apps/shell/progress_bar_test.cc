#include "apps/shell/progress_bar.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

TEST(ProgressBarTest, SaysDurationsInUnitsOfTheirSize) {
  EXPECT_EQ(FormatDuration(0.2), "0 s");
  EXPECT_EQ(FormatDuration(59.4), "59 s");
  EXPECT_EQ(FormatDuration(59.6), "1 min 00 s");
  EXPECT_EQ(FormatDuration(248.0), "4 min 08 s");
  EXPECT_EQ(FormatDuration(3 * 3600 + 5 * 60 + 59), "3 h 05 min");
}

TEST(ProgressBarTest, KnowsNoTimeLeftBeforeTheFirstItem) {
  const ProgressBar bar("testing", 3);
  EXPECT_EQ(bar.TimeLeft(0), "?");
  EXPECT_EQ(bar.TimeLeft(3), "0 s");
}

}  // namespace
}  // namespace rgbd_pose
