#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "frontend/files/png_codec.h"

namespace rgbd_pose {
namespace {

// Partly noise, with the largest steps between neighbours.
cv::Mat Image(int type, cv::Size size) {
  cv::Mat image(size, type);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 65536);
  image(cv::Rect(0, 0, (size.width + 1) / 2, size.height)) = 0;
  image.row(0) = 65535;
  return image;
}

TEST(PngEncoderTest, IsDecodedByOpenCvAndByOurselves) {
  for (const int type : {CV_8UC1, CV_16UC1}) {
    for (const cv::Size size : {cv::Size(1, 1), {1, 7}, {9, 1}, {640, 480}}) {
      SCOPED_TRACE(cv::typeToString(type) + " " + std::to_string(size.width));
      const cv::Mat image = Image(type, size);
      const std::string bytes = EncodePngByLibdeflate(image);
      const cv::Mat by_opencv = cv::imdecode(
          std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED);
      ASSERT_EQ(by_opencv.type(), type);
      EXPECT_EQ(cv::norm(by_opencv, image, cv::NORM_INF), 0);
      const DecodedPng decoded =
          DecodePng(bytes, type == CV_8UC1 ? PngUse::kGray : PngUse::kDepth);
      ASSERT_EQ(decoded.image.type(), type);
      EXPECT_EQ(cv::norm(decoded.image, image, cv::NORM_INF), 0);
    }
  }
}

// A part of an image, whose rows are not contiguous in memory.
TEST(PngEncoderTest, TakesAPartOfAnImage) {
  const cv::Mat whole = Image(CV_16UC1, {40, 30});
  const cv::Mat part = whole(cv::Rect(15, 5, 20, 20));
  EXPECT_EQ(EncodePngByLibdeflate(part), EncodePngByLibdeflate(part.clone()));
}

TEST(PngEncoderTest, Compresses) {
  const cv::Mat flat(480, 640, CV_16UC1, cv::Scalar(5000));
  EXPECT_LT(EncodePngByLibdeflate(flat).size(), 10000u);
}

}  // namespace
}  // namespace rgbd_pose
