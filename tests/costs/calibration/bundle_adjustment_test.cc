// Bundle adjustment including the camera: initial state, fixed parameters and
// result, on views that are exact except for planted errors.

#include "costs/calibration/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/util/quantile.h"
#include "costs/calibration/landmark_factors.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr double kSigmaPx = 0.5;
constexpr double kInverseSigmaDepth = 200.0;  // m
constexpr double kFocalOff = 4.0;             // px

// Three keyframes and their views through a camera whose fx is not `start`'s.
struct World {
  CalibrationViews views;
  CalibrationVector start, prior;
  CalibrationState truth;

  World() {
    RandomWorld world(21);
    start.setZero();
    start.head<4>() << 525.0, 525.0, 319.5, 239.5;
    start[kDepthFactor] = 1.0;
    for (int k = 0; k < kCalibrationSize; ++k) {
      prior[k] = kCalibrationParameters[k].prior * (k <= kFy ? 525.0 : 1.0);
    }
    truth.theta = start;
    truth.theta[kFx] += kFocalOff;
    truth.world_from_cam = {Rigid3d(), world.Motion(0.1, 0.4),
                            world.Motion(0.1, 0.4)};
    views.world_from_cam = truth.world_from_cam;
    views.twists.resize(3);
    for (int i = 0; i < 40; ++i) {
      Landmark landmark;
      landmark.anchor = i % 3;
      landmark.u = world.Uniform(120.0, 520.0);
      landmark.v = world.Uniform(90.0, 390.0);
      landmark.first_view = static_cast<int>(views.views.size());
      landmark.num_views = 2;
      landmark.depth.inverse_sigma = kInverseSigmaDepth;
      const double d = world.Uniform(0.3, 0.6);
      landmark.depth.value = d;
      truth.inverse_depths.push_back(d);
      for (int k = 0; k < 3; ++k) {
        if (k == landmark.anchor) continue;
        LandmarkView view;
        view.keyframe = k;
        view.sigma_px = kSigmaPx;
        view.depth.inverse_sigma = kInverseSigmaDepth;
        views.views.push_back(view);
      }
      views.landmarks.push_back(landmark);
    }
    SeeExactly();
  }

  // Measurements are set from the residuals of measurements of zero.
  void SeeExactly() {
    const auto model = ModelOf(views);
    const auto poses = PosesOf(truth);
    double r[2];
    for (size_t i = 0; i < views.landmarks.size(); ++i) {
      const Landmark& landmark = views.landmarks[i];
      for (int k = 0; k < landmark.num_views; ++k) {
        LandmarkView& view = views.views[landmark.first_view + k];
        const LandmarkData data = DataOf(views, landmark, view, truth);
        const PoseOf<double>&anchor = poses[landmark.anchor],
              &there = poses[view.keyframe];
        const Eigen::Matrix<double, 1, 1> d(truth.inverse_depths[i]);
        LandmarkPixelFactor{model, data}.Residual(anchor, there, d, truth.theta,
                                                  r);
        view.u = std::abs(r[0]) * kSigmaPx;
        view.v = std::abs(r[1]) * kSigmaPx;
        LandmarkDepthFactor{model, data}.Residual(anchor, there, d, truth.theta,
                                                  r);
        view.depth.value = std::abs(r[0]) / kInverseSigmaDepth;
      }
    }
  }

  BundleAdjustment Problem(int max_iterations = 50) const {
    return {views, {start, prior}, /*training_only=*/false, max_iterations};
  }

  // The cost of a state; the state itself is not changed.
  double CostOf(CalibrationState state) const {
    return Problem(/*max_iterations=*/0).Solve(FreeFocal(), &state);
  }

  static FreeParts FreeFocal() {
    FreeParts free;
    free[kFx] = true;
    return free;
  }
};

TEST(BundleAdjustmentTest, TheTruthCostsWhatThePriorSays) {
  const World world;
  const double off = kFocalOff / world.prior[kFx];
  EXPECT_NEAR(world.CostOf(world.truth), 0.5 * off * off, 1e-9);
}

// With a prior that constrains fx about as strongly as the views do.
TEST(BundleAdjustmentTest, EndsWhereItCostsLeast) {
  World world;
  world.prior[kFx] = 5.0;
  CalibrationState state = world.Problem().Begin(world.start);
  const double cost = world.Problem().Solve(World::FreeFocal(), &state);
  EXPECT_NEAR(world.CostOf(state), cost, 1e-9 * cost);
  const double found = state.theta[kFx] - world.start[kFx];
  EXPECT_GT(found, 0.2 * kFocalOff);
  EXPECT_LT(found, 0.98 * kFocalOff);
  for (const double side : {-1.0, 1.0}) {
    CalibrationState beside = state;
    beside.theta[kFx] += side * 0.01 * kFocalOff;
    // All other unknowns are optimised.
    FreeParts none;
    const CalibrationPrior prior = {beside.theta, world.prior};
    BundleAdjustment held(world.views, prior, false, {});
    held.Solve(none, &beside);
    EXPECT_GT(world.CostOf(beside), cost) << side;
  }
}

TEST(BundleAdjustmentTest, ReportsIterationsAndPassesOnWhatTheReportThrows) {
  const World world;
  int iterations = 0;
  const auto solve = [&](int stop) {
    const BundleAdjustment problem(
        world.views, {world.start, world.prior}, /*training_only=*/false,
        BundleAdjustment::kMaxIterations, [&iterations, stop] {
          if (++iterations == stop) throw std::runtime_error("interrupted");
        });
    CalibrationState state = problem.Begin(world.start);
    problem.Solve(World::FreeFocal(), &state);
  };
  solve(/*stop=*/0);
  EXPECT_GT(iterations, 2);
  iterations = 0;
  EXPECT_THROW(solve(/*stop=*/2), std::runtime_error);
  EXPECT_EQ(iterations, 2);
}

TEST(BundleAdjustmentTest, TheFirstPoseStays) {
  World world;
  RandomWorld random(22);
  for (Rigid3d& pose : world.views.world_from_cam) {
    pose = pose * random.Motion(0.01, 0.01);
  }
  const BundleAdjustment problem = world.Problem();
  CalibrationState state = problem.Begin(world.start);
  const CalibrationState before = state;
  ASSERT_TRUE(std::isfinite(problem.Solve(World::FreeFocal(), &state)));
  constexpr double kRounding = 1e-14;  // m, of two inversions
  EXPECT_LT((state.world_from_cam[0].translation -
             before.world_from_cam[0].translation)
                .norm(),
            kRounding);
  for (int k = 1; k < 3; ++k) {
    EXPECT_GT((state.world_from_cam[k].translation -
               before.world_from_cam[k].translation)
                  .norm(),
              1e-3);
    // The relative motion is the true one.
    const Rigid3d error =
        (state.world_from_cam[0].Inverse() * state.world_from_cam[k])
            .Inverse() *
        (world.truth.world_from_cam[0].Inverse() *
         world.truth.world_from_cam[k]);
    EXPECT_LT(error.translation.norm(), 1e-3);
    EXPECT_LT(error.Angle(), 1e-3);
  }
}

// A first keyframe without landmarks and views is not part of the problem.
TEST(BundleAdjustmentTest, TheFirstKeyframeMaySeeNothing) {
  World world;
  for (Landmark& landmark : world.views.landmarks) {
    // Of the two views, the earlier one is in the first keyframe.
    landmark.first_view += 1;
    landmark.num_views = landmark.anchor == 0 ? 0 : 1;
  }
  CalibrationState state = world.Problem().Begin(world.start);
  EXPECT_TRUE(std::isfinite(world.Problem().Solve(World::FreeFocal(), &state)));
}

// In half of a recording, keyframes may be connected through the other half
// only. Then their motion is not determined, but the camera is.
TEST(BundleAdjustmentTest, KeyframesNeedNotBeConnected) {
  World world;
  std::vector<LandmarkView> views;
  for (Landmark& landmark : world.views.landmarks) {
    const int first = landmark.first_view;
    landmark.first_view = static_cast<int>(views.size());
    for (int k = first; k < first + landmark.num_views; ++k) {
      const LandmarkView& view = world.views.views[k];
      if (landmark.anchor != 0 && view.keyframe != 0) views.push_back(view);
    }
    landmark.num_views = static_cast<int>(views.size()) - landmark.first_view;
  }
  world.views.views = views;
  // As much information as thousands of views have.
  world.truth.pixel_scale = world.truth.depth_scale = 0.01;
  const auto variances =
      world.Problem().Variances(World::FreeFocal(), world.truth);
  ASSERT_TRUE(variances.has_value());
  EXPECT_GT((*variances)[kFx], 0.0);
  EXPECT_LT((*variances)[kFx], 1e-2 * world.prior[kFx] * world.prior[kFx]);
}

// Scales are medians of residuals: those of u and v are 0.4 px and 0.6 px, of
// which the median is the larger one, whichever has it; 0.5 sigma in depth,
// where the depths of the anchors are the middle ones.
void ExpectScales(double off_u, double off_v) {
  World world;
  for (size_t i = 0; i < world.views.views.size(); ++i) {
    LandmarkView& view = world.views.views[i];
    view.u += off_u;
    view.v += off_v;
    view.depth.value += (i % 2 == 0 ? 0.1 : 0.9) / kInverseSigmaDepth;
  }
  for (Landmark& landmark : world.views.landmarks) {
    landmark.depth.value += 0.5 / kInverseSigmaDepth;
  }
  CalibrationState state = world.truth;
  state.pixel_scale = 3.0;
  state.depth_scale = 0.1;
  world.Problem().MeasureScales(&state);
  EXPECT_NEAR(state.pixel_scale, kSigmaOfMedian * 0.6 / kSigmaPx, 1e-6);
  EXPECT_NEAR(state.depth_scale, kSigmaOfMedian * 0.5, 1e-6);

  // Without views the scale is 1.
  world.views.views.clear();
  for (Landmark& landmark : world.views.landmarks) landmark.num_views = 0;
  world.Problem().MeasureScales(&state);
  EXPECT_EQ(state.pixel_scale, 1.0);
}

TEST(BundleAdjustmentTest, MeasuresTheScalesOfResiduals) {
  ExpectScales(0.6, -0.4);
  ExpectScales(-0.4, 0.6);
}

}  // namespace
}  // namespace rgbd_pose
