// Direct costs on frames with rolling shutters.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "costs/cost_list.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/direct_columns.h"
#include "tests/support/rolling_frame.h"

namespace rgbd_pose {
namespace {

constexpr int kPrev = 10;
constexpr int kCur = 12;

SyntheticOptions Rolling(bool is_distorted) {
  SyntheticOptions options = SmallImages(is_distorted);
  options.color_shutter = {-0.0075, 0.028};
  options.depth_shutter = {-0.018, 0.028};
  return options;
}

// The previous frame is exposed at one moment, as references are.
DirectPair RollingPair(bool is_distorted, bool knows_twist) {
  const SyntheticDataset global(SmallImages(is_distorted));
  DirectPair pair(global, kPrev, kCur);
  pair.cur.frame = SyntheticDataset(Rolling(is_distorted)).Read(kCur);
  if (knows_twist) pair.cur.frame.twist = TwistOfPath(kCur, SmallImages());
  pair.cur.Build();
  return pair;
}

template <typename Residual>
class DirectRowsTest : public ::testing::Test {
 protected:
  struct Fit {
    double squares = 0.0;   // mean squared residual
    double gradient = 0.0;  // of the mean, by the motion
    int count = 0;
  };
  static Fit FitOf(const DirectPair& pair) {
    DirectCostOf<Residual> cost((DirectOptions()));
    cost.Bind(pair.data());
    cost.Associate(pair.cur_from_prev);
    NormalEquations normal;
    const MotionVector zero = MotionVector::Zero();
    cost.Linearise(
        LinearizationPoint(pair.cur_from_prev).DerivativesAt(zero.data()),
        nullptr, &normal);
    const int count = static_cast<int>(cost.matches().size());
    return {2.0 * normal.cost / count, normal.gradient.norm() / count, count};
  }
};
TYPED_TEST_SUITE(DirectRowsTest, AsGTestTypes<DirectResidualTypes>::type,
                 CostName);

TYPED_TEST(DirectRowsTest, FitTheTrueMotionAsThoseOfOneMomentDo) {
  for (const bool is_distorted : {false, true}) {
    const SyntheticDataset global(SmallImages(is_distorted));
    const auto expected = this->FitOf(DirectPair(global, kPrev, kCur));
    const auto known = this->FitOf(RollingPair(is_distorted, true));
    const auto unknown = this->FitOf(RollingPair(is_distorted, false));
    // The noise differs, some points leave the image, and the velocity changes
    // within the readout.
    EXPECT_LT(known.squares, 1.5 * expected.squares);
    EXPECT_GT(known.count, 0.8 * expected.count);
    const bool sees_more = unknown.squares > 3.0 * known.squares ||
                           unknown.count < 0.6 * known.count;
    EXPECT_TRUE(sees_more) << unknown.squares << " of " << unknown.count;
    EXPECT_GT(unknown.gradient, 3.0 * known.gradient);
  }
}

// On any machine, lanes give the same values as scalars.
TYPED_TEST(DirectRowsTest, LanesAreScalars) {
  constexpr int kPoints = 500;
  for (const bool is_distorted : {false, true}) {
    const DirectPair pair = RollingPair(is_distorted, true);
    const PackedColumns points = PointsOf<TypeParam>(pair, 1, kPoints);
    const DirectInput input = InputOf(pair, 1, pair.cur_from_prev);
    ASSERT_TRUE(input.moves_color && input.moves_depth);
    const PackedColumns seen = SeenColumns<TypeParam>(input, points);
    int count = 0;
    for (int i = 0; i < points.size; ++i) {
      double point[TypeParam::kPointColumns];
      for (int k = 0; k < TypeParam::kPointColumns; ++k) {
        point[k] = points.values[k * points.stride + i];
      }
      ProjectedPoint<double> place;
      TypeParam::Locate(input, point, &place);
      float floats[TypeParam::kSamples];
      if (!(place.z > DirectInput::kMinDepth) ||
          !TypeParam::Read(input, place.u, place.v, 1, floats)) {
        continue;
      }
      double samples[TypeParam::kSamples];
      std::copy(std::begin(floats), std::end(floats), samples);
      double columns[TypeParam::kColumns], rejection;
      TypeParam::LookUp(input, point, samples, columns, &rejection);
      if (rejection >= 1.0) continue;
      ASSERT_LT(count, seen.size);
      for (int k = 0; k < TypeParam::kColumns; ++k) {
        // Positions within a pixel are floats.
        const double size = std::max(1.0, std::abs(columns[k]));
        EXPECT_NEAR(seen.values[k * seen.stride + count], columns[k],
                    1e-5 * size);
      }
      ++count;
    }
    EXPECT_EQ(count, seen.size);
    EXPECT_GT(count, 100);
  }
}

}  // namespace
}  // namespace rgbd_pose
