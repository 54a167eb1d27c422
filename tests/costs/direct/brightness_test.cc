// The brightness change between images whose gray levels are known exactly.

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "costs/direct/direct_points.h"

namespace rgbd_pose {
namespace {

constexpr int kWidth = 80;
constexpr int kHeight = 60;

// The gain and bias found for a static camera. Each pixel of the current image
// is `current(u, v)`. Each point is a third of a pixel to the right of a pixel
// and a fifth below it, and was `previous(u, v)` gray levels.
DirectInput Found(const std::function<int(int, int)>& current,
                  const std::function<double(double, double)>& previous) {
  std::vector<uint8_t> gray(kWidth * kHeight);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    gray[i] = static_cast<uint8_t>(current(i % kWidth, i / kWidth));
  }
  FrameView view;
  Camera camera;
  camera.fx = camera.fy = 50.0;
  camera.cx = 40.0;
  camera.cy = 30.0;
  camera.width = kWidth;
  camera.height = kHeight;
  view.levels = {{{gray.data(), kWidth, kHeight, kWidth}, camera}};

  PackedColumns points;
  points.stride = kWidth * kHeight;
  points.values.resize(5 * points.stride);
  for (int v = 3; v < kHeight - 3; v += 2) {
    for (int u = 3; u < kWidth - 3; u += 2) {
      const double x = u + 1.0 / 3.0, y = v + 0.2, z = 2.0;
      const double point[] = {(x - camera.cx) / camera.fx * z,
                              (y - camera.cy) / camera.fy * z, z, 0.01,
                              previous(x, y)};
      for (int k = 0; k < 5; ++k) {
        points.values[k * points.stride + points.size] = point[k];
      }
      ++points.size;
    }
  }
  DirectInput input;
  input.cur = &view;
  EstimateBrightness(points, &input);
  return input;
}

TEST(EstimateBrightnessTest, ReadsBetweenThePixels) {
  const DirectInput same =
      Found([](int u, int v) { return 20 + 2 * u + v; },
            [](double x, double y) { return 20.0 + 2.0 * x + y; });
  EXPECT_NEAR(same.gain, 1.0, 1e-4);
  EXPECT_NEAR(same.bias, 0.0, 1e-2);
}

// The priors are a gain of 1 +- 0.3 and a bias of 0 +- 40. With one gray level,
// only the priors decide on the shares of gain and bias.
TEST(EstimateBrightnessTest, OneGrayLevelIsSharedByWhatIsExpected) {
  for (const double gray : {40.0, 100.0, 160.0}) {
    const DirectInput brighter = Found([](int, int) { return 170; },
                                       [&](double, double) { return gray; });
    EXPECT_NEAR(brighter.gain * gray + brighter.bias, 170.0, 0.1) << gray;
    EXPECT_NEAR((brighter.gain - 1.0) / brighter.bias,
                gray * 0.3 * 0.3 / (40.0 * 40.0), 1e-6)
        << gray;
  }
}

}  // namespace
}  // namespace rgbd_pose
