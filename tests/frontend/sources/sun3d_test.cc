#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>

#include "frontend/sources/open_source.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

constexpr int kFrames = 3;

class Sun3dTest : public testing::Test {
 protected:
  // Depth is 4 ms after colour, and numbered otherwise.
  Sun3dTest() {
    for (int k = 0; k < kFrames; ++k) {
      WriteImage(folder_ / ("image/" + Name(k, 33000 * k) + ".jpg"),
                 ColorImage(k));
      WriteImage(folder_ / ("depth/" + Name(k + 7, 33000 * k + 4000) + ".png"),
                 DepthImage(k));
    }
  }

  static std::string Name(int number, int microseconds) {
    const auto padded = [](int value, size_t width) {
      const std::string digits = std::to_string(value);
      return std::string(width - digits.size(), '0') + digits;
    };
    return padded(number, 7) + "-" + padded(microseconds, 12);
  }

  std::unique_ptr<FrameSource> Open() const {
    SourceOptions options;
    options.path = folder_.path();
    return OpenSource("auto", options);
  }

  TempFolder folder_;
};

TEST_F(Sun3dTest, PairsByTheTimesInNames) {
  ExpectInputError([this] { Open(); }, {"contains no camera calibration"});
  folder_.Write("intrinsics.txt", "30 0 15.5\n0 31 11.5\n0 0 1");
  WriteImage(folder_ / ("image/" + Name(9, 500000) + ".jpg"), ColorImage(0));
  const auto source = Open();
  EXPECT_EQ(source->timestamps(), (std::vector<double>{0.0, 0.033, 0.066}));
  EXPECT_EQ(source->unmatched_color(), 1);
  EXPECT_EQ(source->camera().camera.fy, 31.0);
  EXPECT_EQ(source->camera().depth_scale, 1000.0);
  EXPECT_TRUE(source->remarks().empty());
  for (int k = 0; k < kFrames; ++k) {
    const Frame frame = source->Next()->read();
    EXPECT_EQ(frame.index, k);
    EXPECT_NEAR(frame.depth_delay, 0.004, 1e-9);
    EXPECT_EQ(frame.depth.at<uint16_t>(5, 5), 1000 + k);
    EXPECT_NEAR(frame.gray.at<uint8_t>(5, 5), 68 + k, 3);
  }
}

TEST_F(Sun3dTest, TurnsTheBitsOfDepthBack) {
  folder_.Write("intrinsics.txt", "30 0 15.5\n0 31 11.5\n0 0 1");
  for (int k = 0; k < kFrames; ++k) {
    cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar((1000 + k) << 3));
    depth.at<uint16_t>(0, 0) = static_cast<uint16_t>(9000 << 3 | 9000 >> 13);
    depth.at<uint16_t>(0, 1) = 0;
    WriteImage(folder_ / ("depth/" + Name(k + 7, 33000 * k + 4000) + ".png"),
               depth);
  }
  const auto source = Open();
  EXPECT_NE(source->remarks().front().find("whose bits are rotated"),
            std::string::npos);
  const Frame frame = source->Next()->read();
  EXPECT_EQ(frame.depth.at<uint16_t>(5, 5), 1000);
  EXPECT_EQ(frame.depth.at<uint16_t>(0, 0), 9000);
  EXPECT_EQ(frame.depth.at<uint16_t>(0, 1), 0);
}

TEST_F(Sun3dTest, RefusesImagesOfOtherTimes) {
  std::filesystem::remove_all(folder_ / "depth");
  WriteImage(folder_ / ("depth/" + Name(1, 5000000) + ".png"), DepthImage(0));
  ExpectInputError([this] { Open(); },
                   {folder_.path(), "no colour image", "within 0.02 s"});
}

TEST_F(Sun3dTest, ReportsDamagedImagesAsTheyAreRead) {
  folder_.Write("intrinsics.txt", "30 0 15.5\n0 31 11.5\n0 0 1");
  folder_.Write("depth/" + Name(7, 4000) + ".png", "");
  const auto source = Open();
  ExpectInputError([&] { source->Next()->read(); }, {"0000007-000000004000"});
  EXPECT_EQ(source->Next()->read().depth.at<uint16_t>(5, 5), 1001);
}

}  // namespace
}  // namespace rgbd_pose
