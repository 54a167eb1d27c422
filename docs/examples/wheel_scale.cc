// A robot whose wheels have an unknown radius: a variable of your own, the
// scale of their odometry, beside the poses of the robot's camera, and a factor
// of your own that relates them.
#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "rgbd_pose/core/factors/check_factor.h"
#include "rgbd_pose/core/factors/factor.h"
#include "rgbd_pose/core/factors/pose_manifold.h"
#include "rgbd_pose/costs/cost_factory.h"
#include "rgbd_pose/costs/factors/pair.h"
#include "rgbd_pose/frontend/simulation/synthetic_matches.h"

namespace {

using rgbd_pose::PoseOf;
using rgbd_pose::Rigid3d;

// The camera has moved by `shift` times the scale. Derivatives are automatic,
// as there is no Jacobian.
struct WheelFactor {
  static constexpr char kName[] = "wheels";
  using Scale = rgbd_pose::VectorBlock<1>;
  using Blocks =
      rgbd_pose::BlockList<rgbd_pose::PoseBlock, rgbd_pose::PoseBlock, Scale>;
  static constexpr int kRows = 3;

  Eigen::Vector3d shift;  // in the axes of pose a, for a scale of 1, m
  double sigma = 0.002;   // along each axis, m

  template <typename T>
  bool Residual(const PoseOf<T>& a, const PoseOf<T>& b,
                const Eigen::Matrix<T, 1, 1>& scale, T* r) const {
    Eigen::Map<Eigen::Matrix<T, 3, 1>> error(r);
    error = a.q.conjugate() * Eigen::Matrix<T, 3, 1>(b.p - a.p);
    error = (error - scale[0] * shift.cast<T>()) / T(sigma);
    return true;
  }
};

}  // namespace

int main() {
  constexpr int kFrames = 6;
  constexpr double kTrueScale = 1.04;  // wheels 4 % larger than on the drawing
  // A line for each wrong derivative, of use once there is a Jacobian by hand.
  const std::string errors = rgbd_pose::CheckFactor(WheelFactor{{0, 0, 0.3}});
  std::printf("%s", errors.c_str());
  rgbd_pose::RandomWorld world(1);     // simulates what is measured
  std::array<Rigid3d, kFrames> truth;  // world_from_cam
  std::array<rgbd_pose::PoseVector, kFrames> poses;
  double scale = 1.0;
  ceres::Problem problem;
  for (int i = 0; i < kFrames; ++i) {
    if (i > 0) truth[i] = truth[i - 1] * world.Motion(0.1, 0.2);
    // The start is off by some degrees and centimetres.
    const Rigid3d off = i == 0 ? Rigid3d() : world.Motion(0.05, 0.05);
    poses[i] = rgbd_pose::PoseVectorOf(truth[i] * off);
    rgbd_pose::AddPose(poses[i].data(), &problem);
    if (i == 0) continue;
    const Rigid3d moved = truth[i - 1].Inverse() * truth[i];
    WheelFactor wheels;
    for (int k = 0; k < 3; ++k) {
      const double noise = world.Normal(wheels.sigma);
      wheels.shift[k] = (moved.translation[k] + noise) / kTrueScale;
    }
    problem.AddResidualBlock(rgbd_pose::MakeFactor(wheels), nullptr,
                             poses[i - 1].data(), poses[i].data(), &scale);
    // 200 matches, a tenth of them wrong.
    const auto matches = world.Matches(200, 0.1, moved.Inverse());
    auto costs = rgbd_pose::MakeRobustCosts("bidirectional_point", "cauchy");
    const Rigid3d guess = rgbd_pose::RigidOf(poses[i]).Inverse() *
                          rgbd_pose::RigidOf(poses[i - 1]);
    problem.AddResidualBlock(
        new rgbd_pose::PairFactor(std::move(costs[0]), {&matches}, guess),
        nullptr, poses[i - 1].data(), poses[i].data());
  }
  problem.SetParameterBlockConstant(poses[0].data());
  ceres::Solver::Summary summary;
  ceres::Solve({}, &problem, &summary);

  ceres::Covariance covariance({});
  double variance = 0.0;
  if (!summary.IsSolutionUsable() ||
      !covariance.Compute(std::vector<const double*>{&scale}, &problem) ||
      !covariance.GetCovarianceBlock(&scale, &scale, &variance)) {
    return 1;
  }
  std::printf("the scale is %.4f, sigma %.4f; in truth it is %.4f\n", scale,
              std::sqrt(variance), kTrueScale);
  return 0;
}
