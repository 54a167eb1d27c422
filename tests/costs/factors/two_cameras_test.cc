// Two cameras back to back on one body: one motion from both, and the mounting
// of one of them from what both see.

#include <ceres/covariance.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/factors/pose_manifold.h"
#include "costs/cost_factory.h"
#include "costs/factors/pair.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr int kMatches = 150;
constexpr double kOutliers = 0.1;

struct Rig {
  Rig(unsigned seed, int num_frames)
      : world(seed),
        frames(num_frames),
        world_from_body(frames),
        poses(frames) {
    // Behind the first, 10 cm apart, turned by half a turn and some degrees.
    body_from_cam[1] =
        Rigid3d::FromRotationVector({0.05, 3.1, -0.04}, {0.02, 0.01, -0.1});
    for (int i = 1; i < frames; ++i) {
      // Turns about several axes: a single one does not tell the mounting.
      world_from_body[i] = world_from_body[i - 1] * world.Motion(0.2, 0.2);
    }
    for (int i = 0; i < frames; ++i) {
      poses[i] = PoseVectorOf(world_from_body[i] *
                              (i == 0 ? Rigid3d() : world.Motion(0.02, 0.02)));
      AddPose(poses[i].data(), &problem);
    }
    problem.SetParameterBlockConstant(poses[0].data());
  }

  // All pairs of up to two frames apart that a camera sees. A pose block of its
  // mounting, or null for a constant one.
  void Add(int camera, PoseVector* mounting) {
    PairMounting how{PairMounting::kNone, body_from_cam[camera],
                     body_from_cam[camera]};
    if (mounting != nullptr) how.blocks = PairMounting::kShared;
    const Rigid3d at =
        mounting != nullptr ? RigidOf(*mounting) : body_from_cam[camera];
    for (int ref = 0; ref < frames; ++ref) {
      for (int cur = ref + 1; cur < std::min(ref + 3, frames); ++cur) {
        const auto between = [&](const Rigid3d& a, const Rigid3d& b,
                                 const Rigid3d& mounted) {
          return (b * mounted).Inverse() * (a * mounted);
        };
        const Correspondences matches =
            world.Matches(kMatches, kOutliers,
                          between(world_from_body[ref], world_from_body[cur],
                                  body_from_cam[camera]));
        auto costs = MakeRobustCosts("bidirectional_point", "cauchy");
        std::vector<double*> blocks = {poses[ref].data(), poses[cur].data()};
        if (mounting != nullptr) blocks.push_back(mounting->data());
        problem.AddResidualBlock(
            new PairFactor(
                std::move(costs[0]), {&matches},
                between(RigidOf(poses[ref]), RigidOf(poses[cur]), at), how),
            nullptr, blocks);
      }
    }
  }

  void Solve() {
    ceres::Solver::Options options;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-10;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    EXPECT_TRUE(summary.IsSolutionUsable());
  }

  // Root of the mean square error of all positions, m.
  double Error() const {
    double sum = 0.0;
    for (int i = 0; i < frames; ++i) {
      sum +=
          (poses[i].tail<3>() - world_from_body[i].translation).squaredNorm();
    }
    return std::sqrt(sum / frames);
  }

  RandomWorld world;
  const int frames;
  std::array<Rigid3d, 2> body_from_cam;
  std::vector<Rigid3d> world_from_body;
  std::vector<PoseVector> poses;
  ceres::Problem problem;
};

// One motion from both cameras is better than that of either.
TEST(TwoCamerasTest, OneMotionFromBoth) {
  constexpr int kRigs = 10;
  std::array<double, 3> squares = {};  // camera 0, camera 1, both
  for (int seed = 0; seed < kRigs; ++seed) {
    for (int which = 0; which < 3; ++which) {
      Rig rig(seed, 12);
      if (which != 1) rig.Add(0, nullptr);
      if (which != 0) rig.Add(1, nullptr);
      rig.Solve();
      squares[which] += rig.Error() * rig.Error() / kRigs;
    }
  }
  RecordProperty("rms_mm", std::to_string(1e3 * std::sqrt(squares[0])) + " " +
                               std::to_string(1e3 * std::sqrt(squares[1])) +
                               " " +
                               std::to_string(1e3 * std::sqrt(squares[2])));
  // Twice the information would be half of the squares.
  EXPECT_LT(squares[2], 0.75 * std::min(squares[0], squares[1]));
}

// The mounting of the second camera is found from a guess that is 3 cm and some
// degrees off, and as exactly as its covariance says.
TEST(TwoCamerasTest, TheMountingIsFound) {
  constexpr int kRigs = 5;
  double normalised = 0.0, largest_m = 0.0, largest_rad = 0.0;
  for (int seed = 0; seed < kRigs; ++seed) {
    Rig rig(100 + seed, 60);
    PoseVector mounting =
        PoseVectorOf(rig.body_from_cam[1] * rig.world.Motion(0.1, 0.03));
    AddPose(mounting.data(), &rig.problem);
    rig.Add(0, nullptr);
    rig.Add(1, &mounting);
    rig.Solve();
    const MotionVector off = PoseBlock::Minus(
        mounting.data(), PoseVectorOf(rig.body_from_cam[1]).data());
    largest_rad = std::max(largest_rad, off.head<3>().norm());
    largest_m = std::max(largest_m, off.tail<3>().norm());
    ceres::Covariance covariance({});
    MotionMatrix block;
    ASSERT_TRUE(covariance.Compute(std::vector<const double*>{mounting.data()},
                                   &rig.problem));
    ASSERT_TRUE(covariance.GetCovarianceBlockInTangentSpace(
        mounting.data(), mounting.data(), block.data()));
    normalised += off.dot(block.inverse() * off) / (6 * kRigs);
  }
  RecordProperty("largest", std::to_string(1e3 * largest_m) + " mm " +
                                std::to_string(largest_rad * 180.0 / M_PI) +
                                " degrees, NEES " + std::to_string(normalised));
  EXPECT_LT(largest_m, 0.002);
  EXPECT_LT(largest_rad, 0.05 * M_PI / 180.0);
  // The mean of 30 squares. Cauchy's loss takes some weight from inliers, which
  // makes the covariance larger than the errors.
  EXPECT_GT(normalised, 0.3);
  EXPECT_LT(normalised, 1.6);
}

// A body that turns about one axis only does not tell where along it a camera
// is mounted: the covariance says that this is not determined.
TEST(TwoCamerasTest, OneAxisDoesNotTellTheMounting) {
  Rig rig(200, 12);
  for (int i = 1; i < rig.frames; ++i) {
    rig.world_from_body[i] =
        rig.world_from_body[i - 1] *
        Rigid3d::FromRotationVector({0.0, 0.1, 0.0}, {0.0, 0.0, 0.1});
    rig.poses[i] = PoseVectorOf(rig.world_from_body[i]);
  }
  PoseVector mounting = PoseVectorOf(rig.body_from_cam[1]);
  AddPose(mounting.data(), &rig.problem);
  rig.Add(0, nullptr);
  rig.Add(1, &mounting);
  ceres::Covariance covariance({});
  EXPECT_FALSE(covariance.Compute(std::vector<const double*>{mounting.data()},
                                  &rig.problem));
}

}  // namespace
}  // namespace rgbd_pose
