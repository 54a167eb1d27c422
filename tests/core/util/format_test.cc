#include "core/util/format.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

TEST(FormatTest, ANumberHasTheDigitsThatItsErrorLeaves) {
  EXPECT_EQ(NumberTo(524.90312, 0.0771), "524.903");
  EXPECT_EQ(NumberTo(-5.59642e-05, 7.3e-05), "-0.000056");
  EXPECT_EQ(NumberTo(7.3e-05, 7.3e-05), "0.000073");
  EXPECT_EQ(NumberTo(1234.567, 25.0), "1235");
  EXPECT_EQ(NumberTo(3.2, 1.0), "3.2");
  EXPECT_EQ(NumberTo(0.123456789, 0.0), "0.123457");  // unknown error
}

}  // namespace
}  // namespace rgbd_pose
