#include "core/evaluation/fixing_equations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(FixingParametersTest, UnitsAreThoseOfAGreatDeal) {
  FixingVector x;
  x << 1.0, 0.0, -1.0, 0.0, 2.0, 0.0, 0.5;
  const TruthFixing fixing = FixingAt(x);
  EXPECT_DOUBLE_EQ(fixing.shift, 0.02);
  EXPECT_NEAR(fixing.camera_from_body.Angle(), 2.0 * kRadiansPerDegree, 1e-12);
  EXPECT_LT(fixing.camera_from_body.rotation.y(), 0.0);
  EXPECT_EQ(fixing.camera_from_body.translation,
            Eigen::Vector3d(0.1, 0.0, 0.025));
}

TEST(FixingParametersTest, NamesDirections) {
  const FixingMatrix all = FixingMatrix::Identity();
  EXPECT_THAT(NameFixingDirections(all.leftCols(0)), IsEmpty());
  EXPECT_THAT(NameFixingDirections(all),
              ElementsAre("time shift", "rotation", "lever"));
  EXPECT_THAT(NameFixingDirections(-all.middleCols(2, 1)),
              ElementsAre("rotation about (0.00, 1.00, 0.00)"));
  FixingVector mixed = FixingVector::Zero();
  mixed[0] = mixed[5] = std::sqrt(0.5);
  EXPECT_THAT(NameFixingDirections(mixed),
              ElementsAre("time shift", "lever along (0.00, 1.00, 0.00)"));
}

}  // namespace
}  // namespace rgbd_pose
