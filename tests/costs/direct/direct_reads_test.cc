// Direct costs read neither beyond the image nor less of it than there is.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "costs/direct_cost_list.h"

namespace rgbd_pose {
namespace {

// Whether a residual type reads at a place of an image of 40 x 30.
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

// So far from the first and from the last pixels.
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
  // Between two pixels.
  ExpectBorders<Photometric>(1.0);
  // Of nine depths.
  ExpectBorders<ProjectivePlane>(kSurfaceStep + 1.0);
  ExpectBorders<InverseDepth>(kSurfaceStep + 1.0);
}

}  // namespace
}  // namespace rgbd_pose
