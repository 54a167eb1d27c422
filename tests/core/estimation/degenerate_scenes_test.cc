// Scenes and costs that leave directions of motion undetermined: the status
// names one of them, and all numbers are finite.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/estimation/estimator.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

using ::testing::HasSubstr;
using ::testing::Values;

// Six sigmas for 150 matches with the noise of a Kinect.
constexpr double kMaxAngle = 0.006;        // rad
constexpr double kMaxTranslation = 0.012;  // m

Estimator EstimatorOfCosts(const std::string& costs) {
  return Estimator({}, MakeRobustCosts(costs, "tukey"));
}

void ExpectSane(const MotionEstimate& estimate) {
  EXPECT_TRUE(estimate.cur_from_prev.IsFinite());
  EXPECT_TRUE(estimate.covariance.allFinite());
  EXPECT_TRUE(std::isfinite(estimate.final_cost));
  EXPECT_TRUE(std::isfinite(estimate.sigma));
  EXPECT_EQ(estimate.reason.empty(), estimate.ok());
}

// Matches on the plane z = `depth` of the previous frame, with its normal,
// before and after a motion.
Correspondences MatchesOnAPlane(int count, double depth, const Rigid3d& truth,
                                bool noise) {
  RandomWorld world(21);
  const Camera camera;
  Correspondences matches(camera);
  for (int i = 0; i < count; ++i) {
    Observation prev, cur;
    prev.u = world.Uniform(0.0, camera.width - 1.0);
    prev.v = world.Uniform(0.0, camera.height - 1.0);
    prev.depth = depth;
    const Eigen::Vector3d point = truth * matches.Point(prev);
    const Eigen::Vector2d pixel = camera.Project(point);
    cur.u = pixel.x();
    cur.v = pixel.y();
    cur.depth = point.z();
    cur.normal = truth.rotation * Eigen::Vector3d(0.0, 0.0, -1.0);
    for (Observation* o : {&prev, &cur}) {
      o->sigma_depth =
          FindNamed(DepthNoiseModels(), "khoshelham")->sigma(o->depth);
      if (noise) world.AddNoise(o);
    }
    matches.Add(prev, cur);
  }
  return matches;
}

// Matches with exact normals on the walls of a corridor 3 m wide and high. Its
// end is so far away that it covers `end_share` of the pixels.
Correspondences MatchesInACorridor(int count, double end_share) {
  RandomWorld world(27);
  const Camera camera;
  const double half = 1.5;  // m
  const double end = 2.0 * half *
                     std::sqrt(camera.fx * camera.fy / end_share /
                               camera.width / camera.height);
  Correspondences matches(camera);
  for (int i = 0; i < count; ++i) {
    Observation o;
    o.u = world.Uniform(0.0, camera.width - 1.0);
    o.v = world.Uniform(0.0, camera.height - 1.0);
    o.depth = 1.0;
    const Eigen::Vector3d ray = matches.Point(o);
    const double side = half / std::abs(ray.x());
    const double floor = half / std::abs(ray.y());
    o.depth = std::min({side, floor, end});
    o.normal = o.depth == end    ? Eigen::Vector3d(0.0, 0.0, -1.0)
               : o.depth == side ? Eigen::Vector3d(1.0, 0.0, 0.0)
                                 : Eigen::Vector3d(0.0, 1.0, 0.0);
    o.sigma_depth = FindNamed(DepthNoiseModels(), "khoshelham")->sigma(o.depth);
    Observation prev = o, cur = o;
    world.AddNoise(&prev);
    world.AddNoise(&cur);
    matches.Add(prev, cur);
  }
  return matches;
}

// Matches on a strip across the image, at one depth and `height` px high.
Correspondences MatchesOnAStrip(int count, double depth, double height,
                                bool noise = true) {
  RandomWorld world(28 + count);
  const Camera camera;
  Correspondences matches(camera);
  for (int i = 0; i < count; ++i) {
    Observation prev, cur;
    prev.u = world.Uniform(0.0, camera.width - 1.0);
    prev.v = camera.cy + world.Uniform(-0.5, 0.5) * height;
    prev.depth = depth;
    prev.sigma_depth =
        FindNamed(DepthNoiseModels(), "khoshelham")->sigma(depth);
    cur = prev;
    if (noise) {
      world.AddNoise(&prev);
      world.AddNoise(&cur);
    }
    matches.Add(prev, cur);
  }
  return matches;
}

class EveryCostTest : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryCostTest, FewerThanThreeMatchesAreTooFew) {
  RandomWorld world(20);
  const Rigid3d truth = world.Motion(0.05, 0.1);
  const MotionPrior prior = world.Prior(truth, 0.01);
  const double missing_depth_share = GetParam() == "epipolar" ? 1.0 : 0.0;
  for (const int count : {0, 1, 2}) {
    const Correspondences matches =
        world.Matches(count, 0.0, truth, /*noise=*/true, missing_depth_share);
    const MotionEstimate estimate =
        EstimatorOfCosts(GetParam()).Estimate(matches, truth, &prior);
    EXPECT_EQ(estimate.status, EstimateStatus::kTooFewMatches) << count;
    ExpectSane(estimate);
  }
}

INSTANTIATE_TEST_SUITE_P(Costs, EveryCostTest, ::testing::ValuesIn(CostNames()),
                         [](const auto& info) { return info.param; });

class OneDepthTest : public ::testing::TestWithParam<std::string> {};

// A wall straight ahead suffices if matches constrain more than a distance.
TEST_P(OneDepthTest, IsEnough) {
  const Rigid3d truth = RandomWorld(22).Motion(0.05, 0.05);
  const MotionEstimate estimate =
      EstimatorOfCosts(GetParam())
          .Estimate(MatchesOnAPlane(150, 2.0, truth, /*noise=*/true));
  EXPECT_TRUE(estimate.ok()) << estimate.reason;
  ExpectSane(estimate);
  const Rigid3d error = estimate.cur_from_prev.Inverse() * truth;
  EXPECT_LE(error.Angle(), kMaxAngle);
  EXPECT_LE(error.translation.norm(), kMaxTranslation);
}

INSTANTIATE_TEST_SUITE_P(Costs, OneDepthTest,
                         Values("bidirectional_point", "bidirectional_image",
                                "point_to_point", "mahalanobis_point",
                                "reprojection", "reprojection_depth"),
                         [](const auto& info) { return info.param; });

// A plane only constrains the distance from it. Translation along the plane and
// rotation about its normal are undetermined, with and without noise.
TEST(DegenerateScenesTest, PointToPlaneOnOnePlane) {
  for (const bool noise : {false, true}) {
    const MotionEstimate estimate =
        EstimatorOfCosts("point_to_plane")
            .Estimate(MatchesOnAPlane(150, 2.0, Rigid3d(), noise));
    EXPECT_EQ(estimate.status, EstimateStatus::kDegenerate);
    ExpectSane(estimate);
    const bool names_one = estimate.reason.find("translation along x") == 0 ||
                           estimate.reason.find("translation along y") == 0 ||
                           estimate.reason.find("rotation about z") == 0;
    EXPECT_TRUE(names_one) << estimate.reason;
  }
}

// Of 30000 matches, even a few percent determine a direction well enough. The
// total information counts, not the information per match.
TEST(DegenerateScenesTest, TheEndOfACorridorIsEnough) {
  for (const double end_share : {0.12, 0.03}) {
    const MotionEstimate estimate =
        EstimatorOfCosts("point_to_plane")
            .Estimate(MatchesInACorridor(30000, end_share));
    EXPECT_TRUE(estimate.ok()) << estimate.reason;
    ExpectSane(estimate);
    const double deviation = std::sqrt(estimate.covariance(5, 5));
    EXPECT_GT(deviation, 0.001);
    EXPECT_LT(deviation, 0.02);
    EXPECT_LT(std::abs(estimate.cur_from_prev.translation.z()),
              4.0 * deviation);
  }
}

// Spurious information about the rotation about a line grows with the number of
// matches, and with the distance, because depth is noisier than image
// positions. Without noise there is none.
TEST(DegenerateScenesTest, NoiseIsNoLeverAboutALine) {
  const auto expect_open = [](const char* cost, const Correspondences& line) {
    SCOPED_TRACE(cost);
    SCOPED_TRACE(line[0].prev.depth);
    SCOPED_TRACE(line.size());
    const MotionEstimate estimate = EstimatorOfCosts(cost).Estimate(line);
    EXPECT_EQ(estimate.status, EstimateStatus::kDegenerate);
    EXPECT_THAT(estimate.reason, HasSubstr("rotation about x"));
    ExpectSane(estimate);
  };
  for (const char* cost : {"bidirectional_point", "mahalanobis_point",
                           "reprojection_depth", "bidirectional_image"}) {
    for (const int count : {10, 100, 5000}) {
      for (const double depth : {0.5, 2.0, 4.0, 8.0}) {
        expect_open(cost, MatchesOnAStrip(count, depth, /*height=*/0.0));
      }
    }
  }
  expect_open("bidirectional_point",
              MatchesOnAStrip(100, 2.0, /*height=*/0.0, /*noise=*/false));
}

TEST(DegenerateScenesTest, AStripOfFourSigmasIsALever) {
  for (const char* cost : {"bidirectional_point", "mahalanobis_point"}) {
    for (const int count : {30, 1000}) {
      const MotionEstimate estimate = EstimatorOfCosts(cost).Estimate(
          MatchesOnAStrip(count, 2.0, /*height=*/20.0));
      EXPECT_TRUE(estimate.ok()) << estimate.reason;
    }
  }
}

// Wrong matches must not determine the rotation about a line of right matches.
TEST(DegenerateScenesTest, WrongMatchesDoNotDetermineARotation) {
  for (const char* loss : {"huber", "tukey", "cauchy"}) {
    Estimator estimator({}, MakeRobustCosts("bidirectional_point", loss));
    int ok = 0;
    for (int seed = 0; seed < 60; ++seed) {
      RandomWorld world(900 + seed);
      Correspondences matches = MatchesOnAStrip(60, 2.0, /*height=*/2.0);
      for (const Match& wrong : world.Matches(15, 1.0, Rigid3d())) {
        matches.Add(wrong.prev, wrong.cur);
      }
      ok += estimator.Estimate(matches).ok();
    }
    EXPECT_LE(ok, 1) << loss;
  }
}

// The status says it; Ceres would log a factorization that fails.
TEST(DegenerateScenesTest, NothingIsLogged) {
  testing::internal::CaptureStderr();
  for (const std::string& cost : CostNames()) {
    for (const char* loss : {"huber", "tukey", "l1"}) {
      Estimator estimator({}, MakeRobustCosts(cost, loss));
      for (const bool noise : {false, true}) {
        for (const int count : {3, 4, 100}) {
          estimator.Estimate(MatchesOnAStrip(count, 2.0, 0.0, noise));
          estimator.Estimate(MatchesOnAPlane(count, 2.0, Rigid3d(), noise));
        }
      }
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Another cost may determine the directions that one cost leaves open.
TEST(DegenerateScenesTest, APriorHelpsOnOnePlane) {
  RandomWorld world(23);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const MotionPrior prior = world.Prior(truth, 0.01);
  Estimator estimator(
      {}, MakeRobustCosts("point_to_plane+motion_prior", "tukey,none"));
  const MotionEstimate estimate = estimator.Estimate(
      MatchesOnAPlane(150, 2.0, truth, /*noise=*/true), prior.mean, &prior);
  EXPECT_TRUE(estimate.ok()) << estimate.reason;
  ExpectSane(estimate);
}

// A gyroscope says how the camera turned, and half of a few matches are wrong:
// what these say on the translation must be confirmed, as without a prior.
TEST(DegenerateScenesTest, APriorOfTheRotationDoesNotConfirmWrongMatches) {
  Estimator estimator(
      {}, MakeRobustCosts("point_to_plane+motion_prior", "tukey,none"));
  int right = 0, wrong = 0;
  for (const int matches : {6, 15, 60}) {
    for (int seed = 0; seed < 100; ++seed) {
      RandomWorld world(3000 + seed);
      const Rigid3d truth = world.Motion(0.1, 0.1);
      MotionPrior prior{truth, MotionMatrix::Zero()};
      prior.information.topLeftCorner<3, 3>().setIdentity();
      prior.information *= 1e6;  // 1 mrad
      const MotionEstimate estimate = estimator.Estimate(
          world.Matches(matches, 0.5, truth), Rigid3d(), &prior);
      if (!estimate.ok()) continue;
      const double chi_squared = SquaredMahalanobisDistance(
          estimate.cur_from_prev, truth, estimate.covariance);
      ++(chi_squared > 40.9 ? wrong : right);  // as rare as five sigmas
    }
  }
  EXPECT_GT(right, 110);
  EXPECT_LE(wrong, 1);
}

// Without any depth, the length of C is undetermined: the weak direction is C.
TEST(DegenerateScenesTest, EpipolarAloneHasNoScale) {
  const char* names[] = {"translation along x", "translation along y",
                         "translation along z"};
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool noise : {false, true}) {
      RandomWorld world(24);
      const Eigen::Vector3d C = 0.3 * Eigen::Vector3d::Unit(axis);
      const Rigid3d truth(Eigen::Quaterniond::Identity(), -C);
      const MotionEstimate estimate =
          EstimatorOfCosts("epipolar")
              .Estimate(world.Matches(150, 0.0, truth, noise,
                                      /*missing_depth_share=*/1.0),
                        truth);
      EXPECT_EQ(estimate.status, EstimateStatus::kDegenerate);
      ExpectSane(estimate);
      EXPECT_EQ(estimate.reason.find(names[axis]), 0u) << estimate.reason;
    }
  }
}

// With a guess without baseline, the epipolar cost can use no match.
TEST(DegenerateScenesTest, EpipolarAloneNeedsAGuess) {
  RandomWorld world(25);
  const Rigid3d truth = world.Motion(0.05, 0.3);
  const MotionEstimate estimate =
      EstimatorOfCosts("epipolar")
          .Estimate(world.Matches(150, 0.0, truth, true,
                                  /*missing_depth_share=*/1.0));
  EXPECT_EQ(estimate.status, EstimateStatus::kTooFewMatches);
  ExpectSane(estimate);
}

// All matches may drop out between stages: here the guess has a baseline, but
// the true motion has none.
TEST(DegenerateScenesTest, EpipolarMatchesMayAllDropOut) {
  RandomWorld world(26);
  const Rigid3d guess(Eigen::Quaterniond::Identity(),
                      Eigen::Vector3d(0.03, 0.0, 0.0));
  const MotionEstimate estimate =
      EstimatorOfCosts("epipolar")
          .Estimate(world.Matches(150, 0.5, Rigid3d(), true, 1.0), guess);
  EXPECT_FALSE(estimate.ok());
  ExpectSane(estimate);
}

}  // namespace
}  // namespace rgbd_pose
