// The spurious information of noise without texture or shape equals the costs'
// model of it.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

#include "costs/cost_list.h"
#include "costs/direct/direct_cost.h"
#include "tests/support/direct_pair.h"

namespace rgbd_pose {
namespace {

constexpr double kWall = 1.5;  // m

// A white wall straight ahead; image and depth contain only noise. Gray noise
// is large enough to make rounding negligible.
DirectFrame NoisyWall(uint32_t seed) {
  const Camera camera = SmallImages().camera.camera;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  const double sigma =
      FindNamed(DepthNoiseModels(), "khoshelham")->sigma(kWall);
  Frame frame;
  frame.gray.create(camera.height, camera.width, CV_8U);
  frame.depth.create(camera.height, camera.width, CV_16U);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      frame.gray.at<uint8_t>(v, u) = cv::saturate_cast<uint8_t>(
          128.0 + 4.0 * Photometric::kSigmaGray * noise(random));
      frame.depth.at<uint16_t>(v, u) = cv::saturate_cast<uint16_t>(
          frame.depth_scale * (kWall + sigma * noise(random)));
    }
  }
  return DirectFrame(frame, camera);
}

// Estimates no brightness change, which would fit noise to noise.
struct Unlit : Photometric {
  static constexpr bool kSeesBrightness = false;
};

// For each motion parameter: the root of the information obtained from noise
// alone over the modelled spurious information.
template <typename Residual>
MotionVector DeterminedOverSpurious(bool is_of_measured_residuals) {
  const DirectFrame prev = NoisyWall(1), cur = NoisyWall(2);
  FramePair pair;
  pair.prev = &prev.view;
  pair.cur = &cur.view;
  DirectOptions options;
  options.min_gradient = 0.0;
  DirectCostOf<Residual> cost(options);
  cost.Bind(pair);
  // Rotated, which spreads positions over the area of a pixel.
  const Rigid3d turn(
      Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ())),
      Eigen::Vector3d::Zero());
  cost.Associate(turn);
  const MotionVector zero = MotionVector::Zero();
  const MotionDerivatives motion =
      LinearizationPoint(turn).DerivativesAt(zero.data());
  NormalEquations sum;
  cost.Linearise(motion, nullptr, &sum);
  MotionMatrix spurious = MotionMatrix::Zero();
  cost.AddSpuriousInformation(motion, &spurious);
  EXPECT_GT(cost.matches().size(), 1000u);
  const double variance =
      is_of_measured_residuals ? 2.0 * sum.cost / cost.matches().size() : 1.0;
  return (sum.hessian.diagonal().cwiseQuotient(spurious.diagonal()) / variance)
      .cwiseSqrt();
}

TEST(SpuriousInformationTest, GrayLevelsOfAWhiteWall) {
  const MotionVector ratio = DeterminedOverSpurious<Unlit>(true);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(ratio[k], 1.0, 0.2) << k;
}

// A plane does not determine motions along it and rotations about its normal.
template <typename Residual>
void ExpectSpuriousOfAPlane() {
  const MotionVector ratio = DeterminedOverSpurious<Residual>(false);
  for (const int k : {2, 3, 4}) {
    EXPECT_NEAR(ratio[k], 1.0, 0.1) << Residual::kName << " " << k;
  }
}

TEST(SpuriousInformationTest, DepthsOfAPlane) {
  ExpectSpuriousOfAPlane<ProjectivePlane>();
  ExpectSpuriousOfAPlane<InverseDepth>();
}

// A slope error rotates the plane about the measured point.
TEST(SpuriousInformationTest, APlaneKeepsItsPoint) {
  const DirectFrame cur = NoisyWall(1);
  DirectInput input;
  input.cur = &cur.view;
  for (const int axis : {0, 1}) {
    double columns[ProjectivePlane::kColumns] = {0.3, -0.4, 1.5};
    ProjectivePlane::NoiseRow(input, axis, columns);
    const Eigen::Map<const Eigen::Vector3d> X(columns), N(columns + 3);
    EXPECT_GT(N.norm(), 1.0);
    EXPECT_NEAR(N.dot(X), 0.0, 1e-9);
    EXPECT_EQ(columns[6], 0.0);
  }
}

}  // namespace
}  // namespace rgbd_pose
