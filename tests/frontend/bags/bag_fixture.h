#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "frontend/sources/open_source.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {

// Expectations for bags of any writer: 30 frames a second, depth 4 ms after
// colour.
class BagTest : public testing::Test {
 public:
  static constexpr double kStart = 1000.0;  // s

  static double StampOf(int k) { return kStart + k / 30.0; }

 protected:
  // Expects that the source gives exactly the `count` frames that were written.
  // Colours from a JPEG are less exact.
  static void ExpectFrames(FrameSource* source, int count,
                           double depth_scale = 1000.0,
                           double gray_tolerance = 1.0) {
    EXPECT_EQ(source->camera().depth_scale, depth_scale);
    EXPECT_EQ(source->camera().camera.cx, SmallCamera().camera.cx);
    for (int k = 0; k < count; ++k) {
      const std::optional<RgbdFrame> next = source->Next();
      ASSERT_TRUE(next.has_value()) << k;
      EXPECT_NEAR(next->timestamp, StampOf(k), 1e-6);
      const Frame frame = next->read();
      EXPECT_EQ(frame.index, k);
      EXPECT_NEAR(frame.depth_delay, 0.004, 1e-6);
      EXPECT_EQ(frame.depth.at<uint16_t>(5, 5),
                std::lround((1000 + k) * depth_scale / 1000.0));
      EXPECT_NEAR(frame.gray.at<uint8_t>(5, 5), 68 + k, gray_tolerance);
    }
    EXPECT_FALSE(source->Next().has_value());
  }

  // Expects an error with all `parts` when the source is opened or read.
  static void ExpectRefusedSource(const SourceOptions& options,
                                  const std::vector<std::string>& parts) {
    ExpectInputError(
        [&] {
          const auto source = OpenSource("auto", options);
          while (const auto next = source->Next()) next->read();
        },
        parts);
  }

  SourceOptions OptionsFor(const std::string& name) const {
    SourceOptions options;
    options.path = folder_ / name;
    return options;
  }

  TempFolder folder_;
};

}  // namespace rgbd_pose
