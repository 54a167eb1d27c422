#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "frontend/sources/open_source.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

// The device of OpenNI's dummy driver: depth and colour at 30 Hz.
constexpr char kDummy[] = "Dummy";
constexpr int kDummyWidth = 320;
constexpr int kDummyHeight = 240;

SourceOptions Options(const std::string& path) {
  SourceOptions options;
  options.path = path;
  options.camera = CameraSetup(
      Camera{kDummyWidth, kDummyHeight, 285.0, 285.0, 159.5, 119.5});
  options.max_time_difference = 0.1;  // its streams do not start together
  return options;
}

void ExpectFrames(FrameSource* source, int count) {
  double last = -1.0;
  for (int k = 0; k < count; ++k) {
    const std::optional<RgbdFrame> next = source->Next();
    ASSERT_TRUE(next.has_value()) << k;
    EXPECT_GT(next->timestamp, last);
    last = next->timestamp;
    const Frame frame = next->read();
    EXPECT_EQ(frame.index, k);
    EXPECT_EQ(frame.gray.size(), cv::Size(kDummyWidth, kDummyHeight));
    EXPECT_EQ(frame.depth.size(), cv::Size(kDummyWidth, kDummyHeight));
    EXPECT_EQ(frame.depth_scale, 1000.0);
  }
}

TEST(OpenNi2SourceTest, SaysWhatIsNotThere) {
  ExpectInputError([] { OpenSource("openni2", Options("no/such/camera")); },
                   {"no/such/camera: cannot be opened", "plugged in"});
}

TEST(OpenNi2SourceTest, ReadsADevice) {
  const auto source = OpenSource("openni2", Options(kDummy));
  ExpectFrames(source.get(), 4);

  SourceOptions options = Options(kDummy);
  options.camera.reset();
  ExpectInputError([&] { OpenSource("openni2", options); },
                   {"Dummy: contains no camera calibration"});
}

TEST(OpenNi2SourceTest, DropsFramesThatNobodyAsksFor) {
  const auto source = OpenSource("openni2", Options(kDummy));
  source->Next();
  while (source->dropped() < 3) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_TRUE(source->Next().has_value());
}

}  // namespace
}  // namespace rgbd_pose
