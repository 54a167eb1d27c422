// Five frames as one problem: all matches of all pairs, the direction of
// gravity in each frame, and a distance that was measured by tape.
#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "rgbd_pose/core/factors/distance.h"
#include "rgbd_pose/core/factors/factor.h"
#include "rgbd_pose/core/factors/pose_manifold.h"
#include "rgbd_pose/costs/cost_factory.h"
#include "rgbd_pose/costs/factors/gravity.h"
#include "rgbd_pose/costs/factors/pair.h"
#include "rgbd_pose/frontend/simulation/synthetic_matches.h"

int main() {
  using rgbd_pose::Rigid3d;
  constexpr int kFrames = 5;
  const Eigen::Vector3d down(0.0, 1.0, 0.0);  // the axis y of the first frame
  rgbd_pose::RandomWorld world(1);            // simulates what is measured
  std::array<Rigid3d, kFrames> truth;         // world_from_cam
  std::array<rgbd_pose::PoseVector, kFrames> poses;
  ceres::Problem problem;
  for (int i = 0; i < kFrames; ++i) {
    if (i > 0) truth[i] = truth[i - 1] * world.Motion(0.1, 0.2);
    // The start is off by some degrees and centimetres.
    const Rigid3d off = i == 0 ? Rigid3d() : world.Motion(0.05, 0.05);
    poses[i] = rgbd_pose::PoseVectorOf(truth[i] * off);
    rgbd_pose::AddPose(poses[i].data(), &problem);
    problem.AddResidualBlock(
        rgbd_pose::MakeFactor(rgbd_pose::GravityFactor{
            truth[i].rotation.conjugate() * down, down, /*sigma=*/0.01}),
        nullptr, poses[i].data());
  }
  problem.SetParameterBlockConstant(poses[0].data());
  problem.AddResidualBlock(
      rgbd_pose::MakeFactor(rgbd_pose::DistanceFactor{
          (truth[0].translation - truth[4].translation).norm(),
          /*sigma=*/0.001}),
      nullptr, poses[0].data(), poses[4].data());
  for (int ref = 0; ref < kFrames; ++ref) {
    for (int cur = ref + 1; cur < kFrames; ++cur) {
      // 200 matches, a tenth of them wrong. The factor copies what it needs.
      const auto matches =
          world.Matches(200, 0.1, truth[cur].Inverse() * truth[ref]);
      auto costs = rgbd_pose::MakeRobustCosts("bidirectional_point", "cauchy");
      const Rigid3d guess = rgbd_pose::RigidOf(poses[cur]).Inverse() *
                            rgbd_pose::RigidOf(poses[ref]);
      problem.AddResidualBlock(
          new rgbd_pose::PairFactor(std::move(costs[0]), {&matches}, guess),
          nullptr, poses[ref].data(), poses[cur].data());
    }
  }
  ceres::Solver::Summary summary;
  ceres::Solve({}, &problem, &summary);

  const double* const last = poses[4].data();
  ceres::Covariance covariance({});
  rgbd_pose::MotionMatrix of_last;  // of [omega p], rad and m
  if (!covariance.Compute(std::vector<const double*>{last}, &problem) ||
      !covariance.GetCovarianceBlockInTangentSpace(last, last,
                                                   of_last.data())) {
    return 1;
  }
  std::printf("%s, the last frame is %.2f mm off, sigma %.2f mm\n",
              summary.IsSolutionUsable() ? "solved" : "not solved",
              1e3 * (poses[4].tail<3>() - truth[4].translation).norm(),
              1e3 * std::sqrt(of_last.bottomRightCorner<3, 3>().trace()));
  return 0;
}
