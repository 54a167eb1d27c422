#include "core/estimation/correspondences.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/depth_noise.h"

namespace rgbd_pose {
namespace {

Observation Good() { return {100.0, 200.0, 2.0, 0.5, 0.01}; }

TEST(CorrespondencesTest, KeepsWhatWasAdded) {
  Correspondences matches;
  ASSERT_TRUE(matches.Add(Good(), {110.0, 190.0, 0.0, 0.7, 0.0}));
  EXPECT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].prev.depth, 2.0);
  EXPECT_EQ(matches[0].cur.u, 110.0);
  EXPECT_EQ(matches[0].cur.depth, 0.0);
  for (const Match& match : matches) EXPECT_EQ(match.prev.u, 100.0);
  matches.Clear();
  EXPECT_EQ(matches.size(), 0u);
}

TEST(CorrespondencesTest, RejectsWhatNoResidualMaySee) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const Observation bad[] = {
      {kNan, 200.0, 2.0, 0.5, 0.01},    {100.0, kInf, 2.0, 0.5, 0.01},
      {100.0, 200.0, kNan, 0.5, 0.01},  {100.0, 200.0, -1.0, 0.5, 0.01},
      {100.0, 200.0, 2.0, 0.0, 0.01},   {100.0, 200.0, 2.0, 0.5, 0.0},
      {100.0, 200.0, 2.0, 0.5, kNan},   {1e100, 200.0, 2.0, 0.5, 0.01},
      {100.0, 200.0, 1e100, 0.5, 0.01}, {100.0, 200.0, 2.0, 1e-100, 0.01},
  };
  Correspondences matches;
  for (const Observation& o : bad) {
    EXPECT_FALSE(matches.Add(o, Good()));
    EXPECT_FALSE(matches.Add(Good(), o));
  }
  EXPECT_EQ(matches.size(), 0u);
  EXPECT_EQ(matches.rejected(), 2 * std::size(bad));
}

TEST(CorrespondencesTest, PointIsOnTheRayAtItsDepth) {
  Camera camera;
  camera.fx = 500;
  camera.fy = 400;
  camera.cx = 320;
  camera.cy = 240;
  const Eigen::Vector3d point =
      Correspondences(camera).Point({420.0, 200.0, 2.0, 0.5, 0.01});
  EXPECT_DOUBLE_EQ(point.x(), 0.4);
  EXPECT_DOUBLE_EQ(point.y(), -0.2);
  EXPECT_DOUBLE_EQ(point.z(), 2.0);
}

TEST(DepthNoiseTest, ModelsAreThePublishedOnes) {
  EXPECT_DOUBLE_EQ(FindNamed(DepthNoiseModels(), "khoshelham")->sigma(2.0),
                   5.7e-3);
  EXPECT_DOUBLE_EQ(FindNamed(DepthNoiseModels(), "nguyen")->sigma(1.4), 3.1e-3);
  EXPECT_DOUBLE_EQ(FindNamed(DepthNoiseModels(), "constant")->sigma(3.0), 5e-3);
  EXPECT_EQ(FindNamed(DepthNoiseModels(), "unknown"), nullptr);
  for (const DepthNoiseModel& model : DepthNoiseModels()) {
    EXPECT_EQ(model.Check(), "") << model.name;
  }
}

TEST(DepthNoiseTest, NoDepthIsCertain) {
  const double nan = std::nan("");
  for (const auto& [constant, quadratic, centre] :
       {std::array<double, 3>{0.0, 0.0, 0.0},
        {-1e-3, 2e-3, 0.0},
        {1e-3, -2e-3, 0.0},
        {0.0, 2e-3, 1.0},
        {nan, 2e-3, 0.0},
        {1e-3, nan, 0.0},
        {1e-3, 2e-3, nan}}) {
    EXPECT_NE((DepthNoiseModel{"", constant, quadratic, centre}.Check()), "")
        << constant << " " << quadratic << " " << centre;
  }
  EXPECT_EQ((DepthNoiseModel{"", 0.0, 2e-3, -0.1}.Check()), "");
}

}  // namespace
}  // namespace rgbd_pose
