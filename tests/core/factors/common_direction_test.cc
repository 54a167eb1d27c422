#include "core/factors/common_direction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/factors/sampler.h"

namespace rgbd_pose {
namespace {

// Wherever the two bodies are, and whichever way the world lies.
TEST(CommonDirectionFactorTest, CountsTheAngleInSigmas) {
  FactorSampler random(2);
  for (const double angle : {0.0, 0.01, 1.0, 3.1}) {
    const Rigid3d a = random.Motion(), b = random.Motion();
    CommonDirectionFactor factor = CommonDirectionFactor::Sample(&random);
    const Eigen::Vector3d seen =
        a.rotation.conjugate() * (b.rotation * factor.in_b);
    factor.in_a = Eigen::AngleAxisd(angle, seen.unitOrthogonal()) * seen;
    Eigen::Vector3d r;
    factor.Residual(PoseFrom(a), PoseFrom(b), r.data());
    EXPECT_NEAR(r.norm(), 2.0 * std::sin(angle / 2.0) / factor.sigma, 1e-9);
  }
}

}  // namespace
}  // namespace rgbd_pose
