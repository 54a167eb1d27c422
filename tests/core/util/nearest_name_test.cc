#include "core/util/nearest_name.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

TEST(NearestNameTest, HasTheFewestChanges) {
  const std::vector<std::string> names = {"readout", "read_out", "offset"};
  EXPECT_EQ(NearestName("readot", names, 2), "readout");
  EXPECT_EQ(NearestName("READ_OUT", names, 0), "read_out");
  EXPECT_EQ(NearestName("ofset", names, 1), "offset");
  EXPECT_EQ(NearestName("ofset", names, 0), "");
  EXPECT_EQ(NearestName("radius", names, 2), "");
  EXPECT_EQ(NearestName("readxout", names, 2), "readout") << "the first";
  EXPECT_EQ(NearestName("", names, 2), "");
  EXPECT_EQ(NearestName("readout", {}, 9), "");
}

}  // namespace
}  // namespace rgbd_pose
