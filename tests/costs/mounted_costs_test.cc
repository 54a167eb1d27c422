// One motion of a body from the pairs of several cameras on it.

#include "costs/mounted_costs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/estimation/residual_jacobian.h"
#include "core/geometry/motion.h"
#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/direct_pair.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

// In front; behind the first and turned by half a turn and some degrees.
const CameraMounting& Front() {
  static const CameraMounting mounting{
      0, Rigid3d::FromRotationVector({0.1, -0.2, 0.3}, {0.3, 0.1, -0.2})};
  return mounting;
}
const CameraMounting& Rear() {
  static const CameraMounting mounting{
      1, Rigid3d::FromRotationVector({0.05, 3.1, -0.04}, {0.02, 0.01, -0.4})};
  return mounting;
}

std::vector<RobustCost> MountedAs(const CameraMounting& mounting,
                                  const std::string& costs,
                                  const std::string& losses) {
  return MountCosts(MakeRobustCosts(costs, losses), mounting);
}

// The costs of both cameras.
std::vector<RobustCost> CostsOfBoth(const std::string& costs,
                                    const std::string& losses) {
  std::vector<RobustCost> all = MountedAs(Front(), costs, losses);
  std::vector<RobustCost> rear = MountedAs(Rear(), costs, losses);
  std::move(rear.begin(), rear.end(), std::back_inserter(all));
  return all;
}

FramePair PairOf(const Correspondences& matches) {
  FramePair pair;
  pair.matches = &matches;
  return pair;
}

// The estimate of a mounted camera is that of the camera, in the axes of the
// body: motion, covariance, weights and cost.
void ExpectSameAsCamera(const MotionEstimate& body,
                        const MotionEstimate& camera,
                        const Rigid3d& body_from_cam) {
  ASSERT_TRUE(camera.ok()) << camera.reason;
  ASSERT_TRUE(body.ok()) << body.reason;
  const MotionError error =
      ErrorOf(body.cur_from_prev,
              body_from_cam * camera.cur_from_prev * body_from_cam.Inverse());
  EXPECT_LT(error.angle, 1e-7);
  EXPECT_LT(error.translation, 1e-7);
  const MotionMatrix jacobian =
      CameraMotionJacobian(body_from_cam, body.cur_from_prev);
  const MotionMatrix of_camera =
      jacobian * body.covariance * jacobian.transpose();
  EXPECT_LT((of_camera - camera.covariance).norm(),
            1e-3 * camera.covariance.norm());
  EXPECT_NEAR(body.final_cost, camera.final_cost, 1e-6 * camera.final_cost);
  EXPECT_EQ(body.num_inliers, camera.num_inliers);
  ASSERT_EQ(body.weights.size(), camera.weights.size());
  for (size_t i = 0; i < body.weights.size(); ++i) {
    EXPECT_NEAR(body.weights[i], camera.weights[i], 1e-4);
    EXPECT_NEAR(body.residual_norms[i], camera.residual_norms[i], 1e-4);
  }
}

TEST(MountedCostsTest, OneCameraIsThatOfItsBody) {
  for (const std::string& cost : CostNames()) {
    SCOPED_TRACE(cost);
    // The latter leaves the length of the translation open.
    if (cost == "motion_prior" || cost == "epipolar") continue;
    RandomWorld world(3);
    const Correspondences matches =
        world.Matches(200, 0.2, world.Motion(0.1, 0.1), /*noise=*/true, 0.1);
    Estimator camera({}, MakeRobustCosts(cost, "tukey"));
    Estimator body({}, MountedAs(Front(), cost, "tukey"));
    ExpectSameAsCamera(body.Estimate(matches), camera.Estimate(matches),
                       Front().body_from_cam);
  }
}

TEST(MountedCostsTest, PixelsOfOneCamera) {
  const SyntheticDataset dataset(SmallImages());
  const DirectPair pair(dataset, 10, 11);
  const auto costs = [] {
    return MakeDirectCosts("photometric+inverse_depth", "tukey");
  };
  Estimator camera({}, costs());
  Estimator body({}, MountCosts(costs(), Front()));
  MotionEstimate of_camera, of_body;
  camera.Estimate(pair.data(), Rigid3d(), &of_camera);
  body.Estimate(pair.data(), Rigid3d(), &of_body);
  ExpectSameAsCamera(of_body, of_camera, Front().body_from_cam);
}

// A wrong entry of the chain from the body to a camera would be seen here.
TEST(MountedCostsTest, DerivativesAreThoseOfTheResiduals) {
  RandomWorld world(5);
  const Rigid3d motion = world.Motion(0.4, 0.4);
  const Correspondences matches = world.Matches(
      40, 0.0, CameraMotion(Front().body_from_cam, motion), /*noise=*/true);
  const FramePair pair = PairOf(matches);
  const RobustCost mounted =
      std::move(MountedAs(Front(), "reprojection", "none").front());
  mounted.cost->Bind(pair);
  mounted.cost->Associate(motion);
  // Not at the origin of the angles, where their rates are the identity.
  const LinearizationPoint origin(motion);
  MotionVector x;
  x << 0.3, -0.2, 0.25, 0.02, -0.03, 0.01;
  const MotionDerivatives at = origin.DerivativesAt(x.data());
  std::vector<double> r, moved;
  mounted.cost->Residuals(at, &r);
  const auto rows = static_cast<Eigen::Index>(r.size());
  ResidualJacobian jacobian(rows, 6);
  constexpr double kStep = 1e-5;
  for (int k = 0; k < 6; ++k) {
    for (const double sign : {1.0, -1.0}) {
      MotionVector step = x;
      step[k] += sign * kStep;
      mounted.cost->Residuals(origin.DerivativesAt(step.data()), &moved);
      const Eigen::Map<Eigen::VectorXd> values(moved.data(), rows);
      if (sign > 0.0) {
        jacobian.col(k) = values / (2.0 * kStep);
      } else {
        jacobian.col(k) -= values / (2.0 * kStep);
      }
    }
  }
  NormalEquations sum;
  mounted.cost->Linearise(at, nullptr, &sum);
  const MotionMatrix hessian = jacobian.transpose() * jacobian;
  const MotionVector gradient =
      jacobian.transpose() * Eigen::Map<Eigen::VectorXd>(r.data(), rows);
  EXPECT_LT((sum.hessian - hessian).norm(), 1e-6 * hessian.norm());
  EXPECT_LT((sum.gradient - gradient).norm(), 1e-6 * gradient.norm());
}

// Each camera sees points on a line and leaves the rotation about it open. The
// two lines cross.
TEST(MountedCostsTest, WhatOneCameraLeavesOpenTheOtherDetermines) {
  RandomWorld world(7);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const auto line = [&](const CameraMounting& mounting,
                        const Eigen::Vector3d& along) {
    const Camera camera;
    const Rigid3d motion = CameraMotion(mounting.body_from_cam, truth);
    Correspondences matches(camera);
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d point =
          Eigen::Vector3d(0.0, 0.0, 2.0) + world.Uniform(-0.7, 0.7) * along;
      Observation seen[2];
      for (const bool is_cur : {false, true}) {
        const Eigen::Vector3d p = is_cur ? motion * point : point;
        const Eigen::Vector2d pixel = camera.Project(p);
        seen[is_cur] = {pixel.x(), pixel.y(), p.z(), 0.5, 0.006};
        world.AddNoise(&seen[is_cur]);
      }
      EXPECT_TRUE(matches.Add(seen[0], seen[1]));
    }
    return matches;
  };
  const Correspondences front = line(Front(), Eigen::Vector3d::UnitX());
  const Correspondences rear = line(Rear(), Eigen::Vector3d::UnitY());
  Estimator alone({}, MakeRobustCosts());
  EXPECT_EQ(alone.Estimate(front).status, EstimateStatus::kDegenerate);
  EXPECT_EQ(alone.Estimate(rear).status, EstimateStatus::kDegenerate);
  Estimator both({}, CostsOfBoth(kDefaultCost, kDefaultLoss));
  MotionEstimate estimate;
  both.Estimate({PairOf(front), PairOf(rear)}, Rigid3d(), &estimate);
  ASSERT_TRUE(estimate.ok()) << estimate.reason;
  const MotionError error = ErrorOf(estimate.cur_from_prev, truth);
  EXPECT_LT(error.angle, 0.005);
  EXPECT_LT(error.translation, 0.005);

  // A second camera that sees the same line leaves the same rotation open.
  std::vector<RobustCost> parallel = MountedAs(Front(), kDefaultCost, "tukey");
  auto same = MountedAs({1, Front().body_from_cam}, kDefaultCost, "tukey");
  std::move(same.begin(), same.end(), std::back_inserter(parallel));
  Estimator degenerate({}, std::move(parallel));
  degenerate.Estimate({PairOf(front), PairOf(front)}, Rigid3d(), &estimate);
  EXPECT_EQ(estimate.status, EstimateStatus::kDegenerate);
}

// Right matches on a narrow strip leave a rotation open, which wrong ones seem
// to determine. What is said of them does not depend on how they are divided
// between two cameras at one place, nor on where these are on the body.
TEST(MountedCostsTest, WrongMatchesAreJudgedAsThoseOfOneCamera) {
  Estimator one({}, MakeRobustCosts());
  std::vector<RobustCost> halves = MountedAs(Front(), kDefaultCost, "tukey");
  halves.push_back(std::move(
      MountedAs({1, Front().body_from_cam}, kDefaultCost, "tukey").front()));
  Estimator two({}, std::move(halves));
  int ok = 0, degenerate = 0;
  for (int seed = 0; seed < 100; ++seed) {
    RandomWorld world(seed);
    const Camera camera;
    Correspondences all(camera), first(camera), second(camera);
    const double height = world.Uniform(2.0, 30.0);  // of the strip, px
    for (int i = 0; i < 60; ++i) {
      Observation prev;
      prev.u = world.Uniform(0.0, camera.width - 1.0);
      prev.v = camera.cy + world.Uniform(-0.5, 0.5) * height;
      prev.depth = 2.0;
      prev.sigma_depth = 0.006;
      Observation cur = prev;
      world.AddNoise(&prev);
      world.AddNoise(&cur);
      all.Add(prev, cur);
    }
    for (const Match& wrong : world.Matches(10, 1.0, Rigid3d())) {
      all.Add(wrong.prev, wrong.cur);
    }
    // Neither half has all the wrong matches, which are the last ones.
    for (size_t i = 0; i < all.size(); ++i) {
      (i % 3 == 0 ? first : second).Add(all[i].prev, all[i].cur);
    }
    const MotionEstimate expected = one.Estimate(all);
    MotionEstimate estimate;
    two.Estimate({PairOf(first), PairOf(second)}, Rigid3d(), &estimate);
    EXPECT_EQ(estimate.status, expected.status) << seed << estimate.reason;
    EXPECT_EQ(estimate.num_used, expected.num_used);
    EXPECT_EQ(estimate.num_inliers, expected.num_inliers);
    ok += expected.ok();
    degenerate += expected.status == EstimateStatus::kDegenerate;
  }
  EXPECT_GT(ok, 10);
  EXPECT_GT(degenerate, 10);
}

// Matches are judged one by one, those of the first camera first, and the
// covariance is that of the errors.
TEST(MountedCostsTest, CovarianceAndInliersOfTwoCameras) {
  constexpr int kTrials = 300;  // give the mean of 6 a sigma of 0.2
  constexpr int kMatches = 100, kWrong = 20;
  Estimator estimator({}, CostsOfBoth(kDefaultCost, kDefaultLoss));
  double nees = 0.0;
  int kept = 0;
  MotionEstimate estimate;
  for (int seed = 0; seed < kTrials; ++seed) {
    RandomWorld world(seed);
    const Rigid3d truth = world.Motion(0.05, 0.05);
    const Correspondences front = world.Matches(
        kMatches, 0.0, CameraMotion(Front().body_from_cam, truth));
    const Correspondences rear =
        world.Matches(kMatches, 1.0 * kWrong / kMatches,
                      CameraMotion(Rear().body_from_cam, truth));
    estimator.Estimate({PairOf(front), PairOf(rear)}, Rigid3d(), &estimate);
    ASSERT_TRUE(estimate.ok()) << estimate.reason << ", seed " << seed;
    ASSERT_EQ(estimate.weights.size(), 2u * kMatches);
    EXPECT_EQ(estimate.num_used, 2 * kMatches);
    for (int i = 0; i < kWrong; ++i) kept += estimate.is_inlier[kMatches + i];
    EXPECT_GT(estimate.num_inliers, 2 * kMatches - kWrong - 15);
    nees += SquaredMahalanobisDistance(estimate.cur_from_prev, truth,
                                       estimate.covariance) /
            kTrials;
  }
  EXPECT_LT(kept, 0.01 * kTrials * kWrong);
  EXPECT_NEAR(nees, 6.0, 0.8);
}

// A prior of the body's motion is a cost of a camera at the body's origin.
TEST(MountedCostsTest, APriorOfTheBody) {
  RandomWorld world(11);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const Correspondences front =
      world.Matches(100, 0.0, CameraMotion(Front().body_from_cam, truth));
  const MotionPrior prior{truth, 1e12 * MotionMatrix::Identity()};
  std::vector<RobustCost> costs = MountedAs(Front(), kDefaultCost, "tukey");
  costs.push_back(
      std::move(MountedAs({1, Rigid3d()}, "motion_prior", "none").front()));
  Estimator estimator({}, std::move(costs));
  FramePair wheels;
  wheels.prior = &prior;
  MotionEstimate estimate;
  estimator.Estimate({PairOf(front), wheels}, Rigid3d(), &estimate);
  ASSERT_TRUE(estimate.ok()) << estimate.reason;
  EXPECT_LT(ErrorOf(estimate.cur_from_prev, truth).translation, 1e-5);
  EXPECT_LT(ErrorOf(estimate.cur_from_prev, truth).angle, 1e-5);
}

TEST(MountedCostsTest, AssembliesAgree) {
  RandomWorld world(13);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const Correspondences front =
      world.Matches(80, 0.1, CameraMotion(Front().body_from_cam, truth));
  const Correspondences rear =
      world.Matches(80, 0.1, CameraMotion(Rear().body_from_cam, truth));
  std::vector<Rigid3d> motions;
  for (const Assembly assembly :
       {Assembly::kCompressed, Assembly::kPerMatch, Assembly::kAutodiff}) {
    EstimatorOptions options;
    options.assembly = assembly;
    Estimator estimator(options, CostsOfBoth("reprojection", "huber"));
    MotionEstimate estimate;
    estimator.Estimate({PairOf(front), PairOf(rear)}, Rigid3d(), &estimate);
    ASSERT_TRUE(estimate.ok()) << estimate.reason;
    motions.push_back(estimate.cur_from_prev);
  }
  for (const Rigid3d& motion : motions) {
    EXPECT_LT(ErrorOf(motion, motions[0]).angle, 1e-12);
    EXPECT_LT(ErrorOf(motion, motions[0]).translation, 1e-12);
  }
}

TEST(MountedCostsTest, RefusesWhatCannotBe) {
  ExpectInputError(
      [] {
        MountedAs({-1, Rigid3d()}, "reprojection", "none");
      },
      {"the index of a camera must not be negative"});
  Rigid3d nowhere;
  nowhere.translation.x() = NAN;
  ExpectInputError(
      [&] {
        MountedAs({2, nowhere}, "reprojection", "none");
      },
      {"the mounting of camera 2 is not finite"});
  std::vector<RobustCost> none(1);
  ExpectInputError([&] { MountCosts(std::move(none), Front()); },
                   {"a mounted cost is null"});
  ExpectInputError(
      [] {
        auto costs = MountedAs(Front(), "reprojection", "none");
        costs.push_back(
            std::move(MountedAs({0, Rigid3d()}, "epipolar", "none").front()));
        Estimator({}, std::move(costs));
      },
      {"camera 0 has costs with two different mountings"});
  const Correspondences matches;
  Estimator estimator({}, CostsOfBoth("reprojection", "none"));
  ExpectInputError([&] { estimator.Estimate(matches); },
                   {"the costs need the pairs of 2 camera(s), but the number "
                    "of pairs is 1"});
  MotionEstimate estimate;
  estimator.Estimate({PairOf(matches), PairOf(matches)}, Rigid3d(), &estimate);
  EXPECT_EQ(estimate.status, EstimateStatus::kTooFewMatches);
  // A pair that no cost would use.
  Estimator of_one({}, MakeRobustCosts());
  ExpectInputError(
      [&] {
        of_one.Estimate({PairOf(matches), PairOf(matches)}, Rigid3d(),
                        &estimate);
      },
      {"the costs need the pairs of 1 camera(s), but the number of pairs is "
       "2"});
}

}  // namespace
}  // namespace rgbd_pose
