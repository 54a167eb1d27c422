#include "frontend/files/pnm_decoder.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

TEST(PnmDecoderTest, GreyHasTheUpperByteFirst) {
  const std::string file = std::string("P5\n2 1\n65535\n") + "\x01\x02\xFF\xFE";
  ASSERT_TRUE(IsPnm(file));
  const cv::Mat image = DecodePnm(file, "");
  ASSERT_EQ(image.type(), CV_16UC1);
  ASSERT_EQ(image.size(), cv::Size(2, 1));
  EXPECT_EQ(image.at<uint16_t>(0, 0), 0x0102);
  EXPECT_EQ(image.at<uint16_t>(0, 1), 0xFFFE);
}

TEST(PnmDecoderTest, ColourHasRedFirst) {
  const cv::Mat image = DecodePnm("P6 1 1 255 \x03\x02\x01", "");
  ASSERT_EQ(image.type(), CV_8UC3);
  EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
}

TEST(PnmDecoderTest, CommentsAreSkipped) {
  const cv::Mat image =
      DecodePnm("P5\n# by a camera\n# 9 9\n2 1\n# largest\n255\nab", "");
  ASSERT_EQ(image.size(), cv::Size(2, 1));
  EXPECT_EQ(image.at<uint8_t>(0, 1), 'b');
}

TEST(PnmDecoderTest, RefusesDamage) {
  for (const char* file :
       {"P5", "P5\n", "P5\n2 1\n255\na", "P5\n2 1\n255", "P5\n2 1\n0\nab",
        "P5\n-2 1\n255\nab", "P5\n2 x\n255\nab", "P5\n99999 99999\n255\nab",
        "P5\n2 1\n99999999999\nabcd", "P6\n1 1\n255\nab", "P5\n#"}) {
    ExpectInputError([&] { DecodePnm(file, "a.pgm"); },
                     {"a.pgm: is damaged or cut off"});
  }
}

}  // namespace
}  // namespace rgbd_pose
