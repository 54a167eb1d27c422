#include "frontend/files/png_codec.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/expect_input_error.h"
#include "tests/support/image_oracle.h"

namespace rgbd_pose {
namespace {

TEST(PngCodecTest, ReadsAnyKindAsOpenCvDoes) {
  for (const int type :
       {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}) {
    SCOPED_TRACE(type);
    const std::string file = EncodedByOpenCv(".png", SmoothImage(type));
    ASSERT_TRUE(IsPng(file));
    ExpectEqual(DecodeAnyPng(file, "", false),
                ByOpenCv(file, cv::IMREAD_UNCHANGED));
    const cv::Mat color = DecodeAnyPng(file, "", true);
    if (CV_MAT_DEPTH(type) == CV_8U) {
      ExpectEqual(color, ByOpenCv(file, cv::IMREAD_COLOR));
    } else {
      EXPECT_EQ(color.type(), CV_16UC4);
    }
  }
}

TEST(PngCodecTest, ReadsGreyOfOneBit) {
  cv::Mat image(48, 61, CV_8UC1, cv::Scalar(0));
  image.colRange(10, 30).setTo(255);
  const std::string file =
      EncodedByOpenCv(".png", image, {cv::IMWRITE_PNG_BILEVEL, 1});
  ExpectEqual(DecodeAnyPng(file, "", false), image);
}

TEST(PngCodecTest, OpenCvReadsWhatItWrites) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    const cv::Mat image = SmoothImage(type);
    const cv::Mat before = image.clone();
    ExpectEqual(ByOpenCv(EncodePng(image), cv::IMREAD_UNCHANGED), image);
    const cv::Mat part = image(cv::Rect(5, 7, 16, 8));
    ExpectEqual(ByOpenCv(EncodePng(part), cv::IMREAD_UNCHANGED), part);
    ExpectEqual(image, before);
  }
}

TEST(PngCodecTest, RefusesDamage) {
  const std::string file = EncodePng(SmoothImage(CV_8UC3));
  for (const size_t size : {size_t{20}, file.size() / 2, file.size() - 1}) {
    ExpectInputError(
        [&] { DecodeAnyPng(file.substr(0, size), "a.png", false); },
        {"a.png: is damaged or cut off"});
  }
  std::string changed = file;
  changed[file.size() / 2] ^= 1;
  ExpectInputError([&] { DecodeAnyPng(changed, "b.png", true); },
                   {"b.png: is damaged"});
}

}  // namespace
}  // namespace rgbd_pose
