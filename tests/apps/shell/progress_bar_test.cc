#include "apps/shell/progress_bar.h"

#include <gtest/gtest.h>

#include <string>

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

TEST(ProgressBarTest, CountsIfTheTotalIsUnknown) {
  EXPECT_EQ(ProgressBar("tracking", 0).Text(50), "tracking 50");
  EXPECT_EQ(ProgressBar("tracking", 2).Text(2),
            "tracking [" + std::string(30, '#') + "] 2/2, 0 s left");
}

}  // namespace
}  // namespace rgbd_pose
