// A problem of your own, solved with factors: a camera goes round a square and
// comes back; each motion is measured, and so is the one that closes the loop.
#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "rgbd_pose/core/factors/factor.h"
#include "rgbd_pose/core/factors/pose_manifold.h"
#include "rgbd_pose/core/factors/relative_pose.h"
#include "rgbd_pose/core/factors/sqrt_information.h"

int main() {
  using rgbd_pose::MotionMatrix;
  using rgbd_pose::Rigid3d;
  // A quarter of the square, as measured: 1 degree too much, 1 m ahead.
  const Rigid3d next_from_this =
      Rigid3d::FromRotationVector({0.0, 91.0 * M_PI / 180.0, 0.0}, {0, 0, 0}) *
      Rigid3d(Eigen::Quaterniond::Identity(), {0.0, 0.0, -1.0});
  MotionMatrix covariance = MotionMatrix::Zero();  // of [omega C]: rad^2, m^2
  covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6;
  const MotionMatrix S = rgbd_pose::SqrtInformationOfCovariance(covariance);

  std::array<rgbd_pose::PoseVector, 4> poses;  // world_from_cam
  Rigid3d world_from_cam;
  for (rgbd_pose::PoseVector& pose : poses) {
    pose = rgbd_pose::PoseVectorOf(world_from_cam);
    world_from_cam = world_from_cam * next_from_this.Inverse();
  }
  ceres::Problem problem;
  for (rgbd_pose::PoseVector& pose : poses) {
    rgbd_pose::AddPose(pose.data(), &problem);
  }
  problem.SetParameterBlockConstant(poses[0].data());
  for (int i = 0; i < 4; ++i) {
    problem.AddResidualBlock(
        rgbd_pose::MakeFactor(rgbd_pose::RelativePoseFactor{next_from_this, S}),
        nullptr, poses[i].data(), poses[(i + 1) % 4].data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve({}, &problem, &summary);
  const double angle = 2.0 * std::acos(std::abs(poses[1][3]));
  std::printf("%s, a quarter is %.2f degrees\n",
              summary.IsSolutionUsable() ? "solved" : "not solved",
              angle * 180.0 / M_PI);
  return 0;
}
