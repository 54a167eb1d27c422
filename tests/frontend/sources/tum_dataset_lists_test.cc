#include <gtest/gtest.h>

#include <filesystem>

#include "frontend/sources/image_pairing.h"
#include "frontend/sources/open_source.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

using TumListsTest = TumSequenceTest;

struct BadList {
  const char* name;
  const char* file;  // the list to replace
  const char* text;
  std::vector<std::string> message_parts;
};

class BadTumListsTest : public TumSequenceTest,
                        public testing::WithParamInterface<BadList> {};

TEST_P(BadTumListsTest, IsRefusedNamingFileAndLine) {
  const std::string path = folder_.Write(GetParam().file, GetParam().text);
  if (GetParam().file == std::string("associations.txt")) {
    options_.associations_file = path;
  }
  ExpectRefused(GetParam().message_parts);
}

INSTANTIATE_TEST_SUITE_P(
    Tum, BadTumListsTest,
    testing::Values(
        BadList{"Empty", "rgb.txt", "", {"rgb.txt: "}},
        BadList{"OnlyComments", "depth.txt", "# a\n\n", {"depth.txt: "}},
        BadList{"OutOfOrder",
                "rgb.txt",
                "# x\n1.04 rgb/1.jpg\n1.00 rgb/0.png\n",
                {"rgb.txt:3:", "earlier"}},
        BadList{"NaN",
                "rgb.txt",
                "1.0 rgb/0.png\nnan rgb/1.jpg\n",
                {"rgb.txt:2:", "'nan'", "time stamp"}},
        BadList{"NoNumber",
                "rgb.txt",
                "rgb/0.png 1.0\n",
                {"rgb.txt:1:", "'rgb/0.png'"}},
        BadList{"OneColumn",
                "rgb.txt",
                "1.0 rgb/0.png\n\n1.04\n",
                {"rgb.txt:3:", "2 columns", "'1.04'"}},
        BadList{"NothingAssociates",
                "depth.txt",
                "7.5 depth/0.png\n",
                {"rgb.txt", "depth.txt", "1.0", "7.5"}},
        BadList{"AssociationsEmpty",
                "associations.txt",
                "#\n",
                {"associations.txt: "}},
        BadList{"AssociationsThreeColumns",
                "associations.txt",
                "1.00 rgb/0.png 1.005 depth/0.png\n1.04 rgb/1.jpg 1.039\n",
                {"associations.txt:2:", "4 columns", "has 3",
                 "'1.04 rgb/1.jpg 1.039'"}},
        BadList{"AssociationsPathForTime",
                "associations.txt",
                "rgb/0.png 1.00 depth/0.png 1.005\n",
                {"associations.txt:1:", "'rgb/0.png'"}},
        BadList{"AssociationsNaN",
                "associations.txt",
                "1.00 rgb/0.png nan depth/0.png\n",
                {"associations.txt:1:", "'nan'"}},
        BadList{"AssociationsOutOfOrder",
                "associations.txt",
                "1.039 depth/1.png 1.04 rgb/1.jpg\n"
                "1.005 depth/0.png 1.00 rgb/0.png\n",
                {"associations.txt:2:", "earlier"}},
        BadList{"AssociationsOnlyColor",
                "associations.txt",
                "1.00 rgb/0.png 1.005 rgb/3.png\n",
                {"associations.txt:1:", "colour", "depth", "rgb/3.png"}}),
    [](const auto& info) { return info.param.name; });

// Unreadable images are detected later, when they are read.
TEST_F(TumListsTest, TakesOneImageOfATimeStamp) {
  folder_.Write("depth.txt",
                "1.005 depth/0.png\n1.005 depth/9.png\n1.04 depth/1.png\n");
  const std::string remark = SameStampRemark(folder_.path(), 1);
  auto dataset = OpenTum(options_);
  ASSERT_EQ(dataset->size(), 2);
  EXPECT_EQ(dataset->remarks(), std::vector<std::string>{remark});
  EXPECT_EQ(dataset->Read(0).depth.at<uint16_t>(3, 3), 1000);
  UseAssociations("1 rgb/0.png 1 depth/0.png\n1 rgb/1.jpg 1 depth/9.png\n");
  dataset = OpenTum(options_);
  EXPECT_EQ(dataset->size(), 1);
  EXPECT_EQ(dataset->remarks(), std::vector<std::string>{remark});
}

TEST_F(TumListsTest, RefusesAMissingList) {
  std::filesystem::remove(folder_ / "rgb.txt");
  ExpectRefused({"rgb.txt: missing"});
}

TEST_F(TumListsTest, RefusesMissingAssociations) {
  options_.associations_file = folder_ / "pairs.txt";
  ExpectRefused({"pairs.txt"});
}

}  // namespace
}  // namespace rgbd_pose
