// Direct costs read the whole image, but nothing outside it.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "costs/cost_list.h"

namespace rgbd_pose {
namespace {

// Whether a residual type can be read at a position of a 40 x 30 image.
template <typename Residual>
bool IsRead(double u, double v) {
  constexpr int kWidth = 40, kHeight = 30;
  const std::vector<uint8_t> gray(kWidth * kHeight, 100);
  const std::vector<uint16_t> depth(kWidth * kHeight, 5000);
  FrameView view;
  view.levels = {{{gray.data(), kWidth, kHeight, kWidth}, {}}};
  view.depth = {depth.data(), kWidth, kHeight, kWidth};
  DirectInput input;
  input.cur = &view;
  float samples[Residual::kSamples];
  return Residual::Read(input, u, v, 1, samples);
}

// The image can be read up to `border` from its first and last pixels.
template <typename Residual>
void ExpectBorders(double border) {
  constexpr double kLittle = 0.01;
  for (const bool is_inside : {true, false}) {
    const double inwards = is_inside ? kLittle : -kLittle;
    EXPECT_EQ(IsRead<Residual>(border + inwards, 15.0), is_inside);
    EXPECT_EQ(IsRead<Residual>(20.0, border + inwards), is_inside);
    EXPECT_EQ(IsRead<Residual>(39.0 - border - inwards, 15.0), is_inside);
    EXPECT_EQ(IsRead<Residual>(20.0, 29.0 - border - inwards), is_inside);
  }
}

TEST(DirectReadsTest, EndAtTheBorders) {
  // Interpolates between two pixels.
  ExpectBorders<Photometric>(1.0);
  // Reads nine depths.
  ExpectBorders<ProjectivePlane>(kSurfaceStep + 1.0);
  ExpectBorders<InverseDepth>(kSurfaceStep + 1.0);
}

}  // namespace
}  // namespace rgbd_pose
