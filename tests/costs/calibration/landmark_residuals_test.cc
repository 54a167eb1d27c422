// Compares every hand-written Jacobian of a calibration with ceres::Jet.

#include "costs/calibration/landmark_residuals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "costs/calibration/landmark_block.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/landmark_oracle.h"

namespace rgbd_pose {
namespace {

// Rounding, relative to the largest entry of a block. Newton's method for the
// lens stops at 1e-13.
constexpr double kTolerance = 1e-10;
constexpr int kSamples = 500;

// A landmark seen by two cameras with a lens, all with small errors.
struct LandmarkSample {
  Camera rest;
  LinearizationPoint anchor, view;
  CalibrationOrigin origin;
  LandmarkData data;
  double d = 0.0;
  MotionVector x_anchor, x_view;
  CalibrationVector y;

  // `lens`: 0 plumb bob, 1 rational, 2 equidistant.
  LandmarkSample(RandomWorld* world, int lens) {
    if (lens == 1) {
      rest.k4 = world->Uniform(0.05, 0.1);
      rest.k5 = world->Uniform(-0.1, 0.1);
      rest.k6 = world->Uniform(-0.1, 0.1);
    } else if (lens == 2) {
      rest.SetDistortion(LensModel::kEquidistant, std::vector<double>(4, 0.0));
    }
    anchor = LinearizationPoint(world->Motion(0.2, 0.3));
    view = LinearizationPoint(world->Motion(0.2, 0.3));
    x_anchor << world->Vector(0.05), world->Vector(0.05);
    x_view << world->Vector(0.05), world->Vector(0.05);
    origin.start << 525.0, 520.0, 319.5, 239.5, 0.1, -0.1, 0.05, 0.01, 0.003,
        -0.002, 0.01, 0.01, 0.02, 0.03, 0.01, 0.02, -0.01, 0.01, 0.02, 0.01,
        1.02;
    for (int k = 0; k < kCalibrationSize; ++k) {
      y[k] = world->Uniform(-0.5, 0.5);
      origin.width[k] =
          kCalibrationParameters[k].prior * (k <= kFy ? 500.0 : 1.0);
    }
    d = world->Uniform(0.2, 1.0);
    data.rest = &rest;
    data.anchor_u = world->Uniform(20.0, 620.0);
    data.anchor_v = world->Uniform(20.0, 460.0);
    data.u = world->Uniform(20.0, 620.0);
    data.v = world->Uniform(20.0, 460.0);
    data.inverse_sigma_px = world->Uniform(1.0, 4.0);
    data.depth.value = world->Uniform(0.2, 1.0);
    data.depth.inverse_sigma = world->Uniform(100.0, 1000.0);
    data.depth.plane = world->Vector(0.5) + Eigen::Vector3d::UnitZ();
    data.depth.ray = world->Vector(0.5);
    data.depth.ray.z() = 1.0;
    for (RowMotion* motion : {&data.anchor_motion, &data.motion}) {
      motion->twist = {world->Vector(1.0), world->Vector(1.0)};
      motion->row = world->Uniform(-0.5, 0.5);
    }
    data.depth.undone_rotation = world->Vector(0.02);
    data.depth.undone_translation = world->Vector(0.02);
  }
};

template <typename Residual>
class LandmarkJacobianTest : public ::testing::Test {};

using CalibrationResiduals =
    ::testing::Types<LandmarkPixel, LandmarkDepth, AnchorDepth>;
TYPED_TEST_SUITE(LandmarkJacobianTest, CalibrationResiduals, CostName);

TYPED_TEST(LandmarkJacobianTest, EqualsTheOracle) {
  constexpr int kRows = TypeParam::kRows;
  constexpr int kSizes[] = {6, 6, 1, kCalibrationSize};
  RandomWorld world(1);
  double largest[4] = {};
  for (int i = 0; i < kSamples; ++i) {
    const LandmarkSample s(&world, i % 3);
    const double* x[] = {s.x_anchor.data(), s.x_view.data(), &s.d, s.y.data()};
    double J_hand[4][kRows * kCalibrationSize];
    double J_jet[4][kRows * kCalibrationSize];
    double* hand[] = {J_hand[0], J_hand[1], J_hand[2], J_hand[3]};
    double* jet[] = {J_jet[0], J_jet[1], J_jet[2], J_jet[3]};
    double r_hand[kRows], r_jet[kRows], r_plain[kRows];
    const LandmarkBlock<TypeParam> block(s.anchor, s.view, s.origin, s.data);
    ASSERT_TRUE(block.Evaluate(x, r_hand, hand));
    ASSERT_TRUE(block.Evaluate(x, r_plain, nullptr));
    LandmarkOracleBlock<TypeParam> oracle(
        new LandmarkOracle<TypeParam>(s.anchor, s.view, s.origin, s.data));
    ASSERT_TRUE(oracle.Evaluate(x, r_jet, jet));
    for (int row = 0; row < kRows; ++row) {
      const double scale = std::max(1.0, std::abs(r_jet[row]));
      EXPECT_NEAR(r_hand[row], r_jet[row], kTolerance * scale);
      EXPECT_NEAR(r_plain[row], r_jet[row], kTolerance * scale);
    }
    for (int block = 0; block < 4; ++block) {
      const int size = kRows * kSizes[block];
      double most = 1e-9;
      for (int k = 0; k < size; ++k) {
        most = std::max(most, std::abs(J_jet[block][k]));
      }
      for (int k = 0; k < size; ++k) {
        EXPECT_NEAR(J_hand[block][k], J_jet[block][k], kTolerance * most)
            << "block " << block << ", entry " << k << ", sample " << i;
      }
      largest[block] = std::max(largest[block], most);
    }
  }
  constexpr bool kHasView = !std::is_same_v<TypeParam, AnchorDepth>;
  for (int block = kHasView ? 0 : 2; block < 4; ++block) {
    EXPECT_GT(largest[block], 1e-3) << "vacuous samples, block " << block;
  }
}

}  // namespace
}  // namespace rgbd_pose
