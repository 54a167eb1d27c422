#include "frontend/files/image_file.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/util/text_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// A small image of noise, which needs many bytes in any format.
cv::Mat Noise(int type) {
  cv::Mat image(24, 32, type);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 255);
  return image;
}

class ImageFileTest : public testing::Test {
 protected:
  std::string Write(const std::string& name, const cv::Mat& image) {
    EXPECT_TRUE(cv::imwrite(folder_ / name, image));
    return folder_ / name;
  }

  void ExpectRefused(const std::string& path,
                     const std::vector<std::string>& message_parts) {
    ExpectInputError([&] { ReadImageFile(path); }, message_parts);
  }

  // Expects that no truncated file is accepted as the whole image.
  void ExpectAnyCutRefused(const std::string& name, const cv::Mat& image) {
    const std::string path = Write(name, image);
    EXPECT_NO_THROW(ReadImageFile(path));
    const std::string content = ReadTextFile(path);
    for (size_t size = 0; size < content.size(); size += 13) {
      folder_.Write(name, content.substr(0, size));
      ExpectRefused(path, {path});
    }
    folder_.Write(name, content.substr(0, content.size() - 1));
    ExpectRefused(path, {path});
  }

  TempFolder folder_;
};

TEST_F(ImageFileTest, RefusesCutOffPng) {
  ExpectAnyCutRefused("color.png", Noise(CV_8UC3));
  ExpectAnyCutRefused("depth.png", Noise(CV_16UC1));
}

// Libraries accept these and fill the missing part with grey.
TEST_F(ImageFileTest, RefusesCutOffJpeg) {
  ExpectAnyCutRefused("color.jpg", Noise(CV_8UC3));
}

TEST_F(ImageFileTest, TakesBytesBehindAJpeg) {
  const std::string path = Write("color.jpg", Noise(CV_8UC3));
  folder_.Write("color.jpg", ReadTextFile(path) + std::string(100, '\0'));
  EXPECT_NO_THROW(ReadImageFile(path));
}

TEST_F(ImageFileTest, RefusesWhatIsNoImage) {
  ExpectRefused(folder_ / "nowhere.png", {"nowhere.png"});
  ExpectRefused(folder_.path(), {folder_.path()});
  ExpectRefused(folder_.Write("empty.png", ""), {"empty.png", "empty"});
  ExpectRefused(folder_.Write("text.png", "text"),
                {"text.png", "not in a supported format"});
  ExpectRefused(Write("color.tiff", Noise(CV_8UC3)),
                {"color.tiff", "not in a supported format (PNG, JPEG,"});
}

TEST_F(ImageFileTest, ReadsTheKindsThatRecordingsComeIn) {
  const cv::Mat color = Noise(CV_8UC3);
  for (const char* name : {"a.png", "a.jpg", "a.ppm"}) {
    const cv::Mat image = ReadImageFile(Write(name, color));
    EXPECT_EQ(image.size(), color.size()) << name;
  }
  const cv::Mat depth = Noise(CV_16UC1);
  for (const char* name : {"a.png", "a.pgm"}) {
    const cv::Mat image = ReadDepthImageFile(Write(name, depth));
    EXPECT_EQ(cv::norm(image, depth, cv::NORM_INF), 0) << name;
  }
}

TEST_F(ImageFileTest, DepthMustHaveSixteenBitsAndOneChannel) {
  for (const auto& [type, name] :
       {std::pair(CV_8UC1, "CV_8UC1"), std::pair(CV_8UC3, "CV_8UC3"),
        std::pair(CV_16UC3, "CV_16UC3")}) {
    const std::string path = Write("depth.png", Noise(type));
    ExpectInputError([&] { ReadDepthImageFile(path); },
                     {"depth.png", "16 bits", name});
  }
}

TEST_F(ImageFileTest, ColourMustHaveEightBits) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    EXPECT_EQ(ReadGrayImageFile(Write("color.png", Noise(type))).type(),
              CV_8UC1);
  }
  for (const int type : {CV_16UC1, CV_16UC3}) {
    const std::string path = Write("color.png", Noise(type));
    ExpectInputError([&] { ReadGrayImageFile(path); },
                     {path, "a colour image or a mask", "8 bits"});
  }
}

TEST_F(ImageFileTest, GreyImagesHaveThreeColoursIfAskedFor) {
  const cv::Mat gray = Noise(CV_8UC1);
  for (const char* name : {"a.png", "a.pgm"}) {
    SCOPED_TRACE(name);
    cv::Mat color;
    const cv::Mat read = ReadGrayImageFile(Write(name, gray), &color);
    EXPECT_EQ(cv::norm(read, gray, cv::NORM_INF), 0);
    ASSERT_EQ(color.type(), CV_8UC3);
    for (const int channel : {0, 1, 2}) {
      cv::Mat one;
      cv::extractChannel(color, one, channel);
      EXPECT_EQ(cv::norm(one, gray, cv::NORM_INF), 0);
    }
  }
}

TEST_F(ImageFileTest, WritesPngFilesAsAWhole) {
  const cv::Mat image = Noise(CV_16UC1);
  WritePngFile(folder_ / "a.png", image);
  EXPECT_EQ(
      cv::norm(ReadDepthImageFile(folder_ / "a.png"), image, cv::NORM_INF), 0);
  ExpectInputError([&] { WritePngFile(folder_ / "none/a.png", image); },
                   {folder_ / "none/a.png", "cannot be written"});
}

// A JPEG with a rotation in its EXIF header (orientation 6) is not rotated.
TEST_F(ImageFileTest, LeavesTheOrientationAlone) {
  const std::string path = Write("color.jpg", Noise(CV_8UC3));
  const std::string content = ReadTextFile(path);
  const char exif[] =
      "\xFF\xE1\x00\x22"
      "Exif\0\0MM\0\x2A\0\0\0\x08"      // big endian, tags at byte 8
      "\0\x01\x01\x12\0\x03\0\0\0\x01"  // one tag: orientation, a short
      "\0\x06\0\0\0\0\0\0";
  folder_.Write("color.jpg", content.substr(0, 2) +
                                 std::string(exif, sizeof(exif) - 1) +
                                 content.substr(2));
  EXPECT_EQ(cv::imread(path, cv::IMREAD_GRAYSCALE).size(), cv::Size(24, 32));
  EXPECT_EQ(ReadImageFile(path).size(), cv::Size(32, 24));
}

}  // namespace
}  // namespace rgbd_pose
