#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "frontend/features/patch.h"

namespace rgbd_pose {
namespace {

// The warp is the derivative of the projection of the plane's points.
TEST(PlaneWarpTest, IsTheDerivativeOfTheMapOfThePlane) {
  const Camera camera;
  const Rigid3d motion(Eigen::Quaterniond(Eigen::AngleAxisd(
                           0.2, Eigen::Vector3d(0.5, -0.3, 0.8).normalized())),
                       Eigen::Vector3d(0.2, -0.1, 0.3));
  Observation ref;
  ref.u = 400.0;
  ref.v = 150.0;
  ref.depth = 2.0;
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(0.4, -0.3, -0.8), Eigen::Vector3d(0.0, 0.0, -1.0),
        Eigen::Vector3d(0.0, 0.0, 0.0)}) {
    ref.normal = normal.normalized();
    // Without a normal, the plane is parallel to the image.
    const Eigen::Vector3d n =
        normal.isZero() ? -Eigen::Vector3d::UnitZ() : ref.normal;
    const Eigen::Vector3d centre =
        camera.Unproject(Eigen::Vector2d(ref.u, ref.v), ref.depth);
    const auto map = [&](double du, double dv) {
      const Eigen::Vector3d ray =
          camera.Unproject(Eigen::Vector2d(ref.u + du, ref.v + dv), 1.0);
      return camera.Project(motion * (n.dot(centre) / n.dot(ray) * ray));
    };
    constexpr double h = 1e-3;
    Eigen::Matrix2d expected;
    expected.col(0) = (map(h, 0.0) - map(-h, 0.0)) / (2.0 * h);
    expected.col(1) = (map(0.0, h) - map(0.0, -h)) / (2.0 * h);
    // The result has single precision.
    EXPECT_LT((PlaneWarp(camera, ref, motion).cast<double>() - expected)
                  .lpNorm<Eigen::Infinity>(),
              1e-6);
    EXPECT_GT((expected - Eigen::Matrix2d::Identity()).norm(), 0.1);
  }
}

}  // namespace
}  // namespace rgbd_pose
