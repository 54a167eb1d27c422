#include "frontend/files/jpeg_codec.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/expect_input_error.h"
#include "tests/support/image_oracle.h"

namespace rgbd_pose {
namespace {

TEST(JpegCodecTest, ReadsAsOpenCvDoes) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const std::string file = EncodedByOpenCv(".jpg", SmoothImage(type));
    ASSERT_TRUE(IsJpeg(file));
    ExpectEqual(DecodeJpeg(file, "", true),
                ByOpenCv(file, cv::IMREAD_GRAYSCALE));
    ExpectEqual(DecodeJpeg(file, "", false), ByOpenCv(file, cv::IMREAD_COLOR));
  }
}

TEST(JpegCodecTest, OpenCvReadsWhatItWrites) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const cv::Mat image = SmoothImage(type);
    const cv::Mat read = ByOpenCv(EncodeJpeg(image, 95), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(read.type(), type);
    EXPECT_LT(cv::norm(read, image, cv::NORM_L1) / image.total(), 9.0);
    // Fewer bytes at a lower quality; part of an image is an image.
    EXPECT_LT(EncodeJpeg(image, 50).size(), EncodeJpeg(image, 95).size());
    EXPECT_EQ(DecodeJpeg(EncodeJpeg(image(cv::Rect(5, 7, 16, 8)), 95), "",
                         type == CV_8UC1)
                  .size(),
              cv::Size(16, 8));
  }
}

TEST(JpegCodecTest, RefusesDamage) {
  const std::string file = EncodeJpeg(SmoothImage(CV_8UC3), 90);
  ExpectInputError([&] { DecodeJpeg(file.substr(0, 100), "a.jpg", true); },
                   {"a.jpg: is damaged or cut off"});
  std::string huge = file;
  const size_t frame = huge.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  huge.replace(frame + 5, 4, "\xFF\xFF\xFF\xFF");  // height and width
  ExpectInputError([&] { DecodeJpeg(huge, "b.jpg", true); },
                   {"b.jpg: is damaged or cut off"});
  std::string no_tables = file;
  const size_t tables = no_tables.find("\xFF\xDB");
  ASSERT_NE(tables, std::string::npos);
  no_tables[tables + 1] = '\xFE';  // a comment
  ExpectInputError([&] { DecodeJpeg(no_tables, "c.jpg", false); },
                   {"c.jpg: cannot be decoded"});
}

}  // namespace
}  // namespace rgbd_pose
