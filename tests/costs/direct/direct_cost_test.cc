// Which points direct costs use, and what their results must not depend on.

#include "costs/direct/direct_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/util/vector_lanes.h"
#include "costs/cost_factory.h"
#include "costs/cost_list.h"
#include "costs/direct_cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"
#include "tests/support/direct_columns.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/motion_error.h"
#include "tests/support/problem_sums.h"

namespace rgbd_pose {
namespace {

DirectPair SmallPair() {
  return DirectPair(SyntheticDataset(SmallImages()), 10, 12);
}

MotionEstimate Estimate(const DirectPair& pair, const std::string& cost,
                        const DirectOptions& options = {}, int threads = 1) {
  EstimatorOptions estimator = DirectEstimatorOptions();
  estimator.threads = threads;
  MotionEstimate estimate;
  Estimator(estimator, MakeDirectCosts(cost, "huber", options))
      .Estimate(pair.data(), Rigid3d(), &estimate);
  return estimate;
}

NormalEquations Linearised(MotionCost* cost, const FramePair& pair,
                           const Rigid3d& motion) {
  cost->Bind(pair);
  cost->Associate(motion);
  NormalEquations sum;
  const MotionVector zero = MotionVector::Zero();
  cost->Linearise(LinearizationPoint(motion).DerivativesAt(zero.data()),
                  nullptr, &sum);
  return sum;
}

class DirectCostTest : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<MotionCost> Make(const DirectOptions& options = {}) const {
    return MakeDirectCost(GetParam(), options);
  }
  size_t Count(const DirectPair& pair, const Rigid3d& motion) const {
    const auto cost = Make();
    cost->Bind(pair.data());
    cost->Associate(motion);
    EXPECT_EQ(cost->degrees(), std::vector<int>(cost->matches().size(), 1));
    EXPECT_THAT(cost->matches(), testing::Each(-1));
    return cost->matches().size();
  }
};

TEST_P(DirectCostTest, WhatIsOutOfViewTakesNoPart) {
  const DirectPair pair = SmallPair();
  const auto turned = [&](double degrees) {
    const Rigid3d turn(Eigen::Quaterniond(Eigen::AngleAxisd(
                           degrees * M_PI / 180.0, Eigen::Vector3d::UnitY())),
                       Eigen::Vector3d::Zero());
    return Count(pair, turn * pair.cur_from_prev);
  };
  const size_t all = turned(0.0);
  EXPECT_GT(all, 500u);
  // The field of view is 63 degrees wide.
  EXPECT_LT(turned(30.0), 0.6 * all);
  EXPECT_EQ(turned(90.0), 0u);
  EXPECT_EQ(turned(180.0), 0u) << "points behind the camera";
}

// A lens sees a point beside the camera at a pixel that fits into no integer:
// the sanitizers of scripts/check would tell.
TEST_P(DirectCostTest, MasksAreAskedWithinTheImageOnly) {
  DirectPair pair(SyntheticDataset(SmallImages(/*is_distorted=*/true)), 10, 12);
  CellMask nothing;
  nothing.columns = pair.cur.camera.width / CellMask::kCellPx + 1;
  for (int degrees = 0; degrees < 90; ++degrees) {
    const Rigid3d turn(Eigen::Quaterniond(Eigen::AngleAxisd(
                           degrees * M_PI / 180.0, Eigen::Vector3d::UnitY())),
                       Eigen::Vector3d::Zero());
    pair.cur.view.moving = nullptr;
    const size_t unmasked = Count(pair, turn * pair.cur_from_prev);
    pair.cur.view.moving = &nothing;
    EXPECT_EQ(Count(pair, turn * pair.cur_from_prev), unmasked) << degrees;
  }
}

// Points are in all four halves of the image, and each half is told apart.
TEST_P(DirectCostTest, WhatIsInAMaskTakesNoPart) {
  DirectPair pair = SmallPair();
  const size_t all = Count(pair, pair.cur_from_prev);
  CellMask mask;
  mask.columns = pair.cur.camera.width / CellMask::kCellPx;
  const int rows = pair.cur.camera.height / CellMask::kCellPx;
  pair.cur.view.moving = &mask;
  const auto masked = [&](const auto& is_in) {
    mask.cells.clear();
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < mask.columns; ++column) {
        mask.cells.push_back(is_in(column, row));
      }
    }
    const size_t left_out = all - Count(pair, pair.cur_from_prev);
    EXPECT_GT(left_out, 0.2 * all);
    return left_out;
  };
  const auto is_left = [&](int column, int /*row*/) {
    return column < mask.columns / 2;
  };
  const auto is_above = [&](int /*column*/, int row) { return row < rows / 2; };
  EXPECT_EQ(masked(is_left) + masked(std::not_fn(is_left)), all);
  EXPECT_EQ(masked(is_above) + masked(std::not_fn(is_above)), all);
}

TEST_P(DirectCostTest, DepthHolesOfThePreviousFrameGiveNoPoints) {
  for (const uint16_t hole : {uint16_t{0}, Frame::kNoDepth}) {
    DirectPair pair = SmallPair();
    pair.prev.frame.depth.setTo(hole);
    EXPECT_EQ(Count(pair, pair.cur_from_prev), 0u) << hole;
  }
}

TEST_P(DirectCostTest, NoImagesAreTooFewMatches) {
  const DirectPair pair = SmallPair();
  Estimator estimator(DirectEstimatorOptions(), MakeDirectCosts(GetParam()));
  const FramePair whole = pair.data();
  FramePair no_prev = whole, no_cur = whole;
  no_prev.prev = nullptr;
  no_cur.cur = nullptr;
  MotionEstimate estimate;
  for (const FramePair& none : {FramePair(), no_prev, no_cur}) {
    // Must also hold after a pair with both views.
    estimator.Estimate(whole, pair.cur_from_prev, &estimate);
    EXPECT_GT(estimate.num_used, 500);
    estimator.Estimate(none, pair.cur_from_prev, &estimate);
    EXPECT_EQ(estimate.status, EstimateStatus::kTooFewMatches);
    EXPECT_EQ(estimate.num_used, 0);
  }
}

// Without images, a sum of match and pixel costs is that of the matches.
TEST_P(DirectCostTest, NoImagesLeaveOtherCostsAlone) {
  RandomWorld world(1);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const Correspondences matches = world.Matches(100, 0.0, truth);
  for (const Assembly assembly : {Assembly::kCompressed, Assembly::kPerMatch}) {
    EstimatorOptions options;
    options.assembly = assembly;
    std::vector<RobustCost> terms =
        MakeRobustCosts("mahalanobis_point", "none");
    terms.push_back({Make(), nullptr});
    const MotionEstimate estimate =
        Estimator(options, std::move(terms)).Estimate(matches);
    EXPECT_TRUE(estimate.ok()) << estimate.reason;
    EXPECT_LE(ErrorOf(estimate.cur_from_prev, truth).translation, 0.01);
  }
}

// Pixels determine the motion beside a few matches, too, of which none is left
// without the three that know most. A corner of the image shows something else.
TEST(DirectEstimateTest, AFewMatchesTakeNothingFromPixels) {
  DirectPair pair = SmallPair();
  cv::Mat corner = pair.cur.frame.gray(cv::Rect(0, 0, 120, 100));
  cv::flip(corner.clone(), corner, 0);
  pair.cur.Build();
  for (const int count : {0, 2, 3, 4}) {
    const Correspondences matches =
        RandomWorld(1).Matches(count, 0.0, pair.cur_from_prev);
    FramePair data = pair.data();
    data.matches = &matches;
    Estimator estimator(
        DirectEstimatorOptions(),
        JoinCosts(MakeRobustCosts("mahalanobis_point", "tukey"),
                  MakeDirectCosts("photometric+inverse_depth", "tukey")));
    MotionEstimate estimate;
    estimator.Estimate(data, Rigid3d(), &estimate);
    EXPECT_TRUE(estimate.ok()) << count << " matches: " << estimate.reason;
  }
}

TEST_P(DirectCostTest, PointsAreKeptForFramesOfOneId) {
  DirectPair pair = SmallPair();
  const DirectPair other(SyntheticDataset(SmallImages()), 30, 32);
  const auto cost = Make();
  const auto linearised = [&](const FrameView& prev, uint64_t id) {
    FrameView view = prev;
    view.id = id;
    FramePair data = pair.data();
    data.prev = &view;
    return Linearised(cost.get(), data, pair.cur_from_prev).hessian;
  };
  const MotionMatrix first = linearised(pair.prev.view, 1);
  const MotionMatrix of_other = linearised(other.prev.view, 2);
  EXPECT_NE(first, of_other);
  // The same id means the same frame: its points are not computed again.
  EXPECT_EQ(linearised(pair.prev.view, 2), of_other);
  EXPECT_EQ(linearised(pair.prev.view, 3), first);
  // Without an id (0), points are computed each time.
  EXPECT_EQ(linearised(other.prev.view, 0), of_other);
  EXPECT_EQ(linearised(pair.prev.view, 0), first);
  // A pair without images changes nothing of this.
  cost->Bind(FramePair());
  EXPECT_EQ(linearised(other.prev.view, 3), first);
  EXPECT_EQ(linearised(other.prev.view, 4), of_other);
}

TEST_P(DirectCostTest, AViewWithoutItsDepthNoiseIsRefused) {
  const DirectPair pair = SmallPair();
  FrameView view = pair.prev.view;
  view.depth_noise = {};
  FramePair data = pair.data();
  data.prev = &view;
  const auto cost = Make();
  ExpectInputError([&] { cost->Bind(data); }, {"depth_noise"});
}

// More than 8192 rows, which gives several chunks of sums.
TEST_P(DirectCostTest, ThreadsDoNotChangeABit) {
  SyntheticOptions whole = SmallImages();
  whole.camera = RgbdCamera();
  const DirectPair pair(SyntheticDataset(whole), 10, 11);
  DirectOptions options;
  options.max_points = 40000;
  options.finest_level = 0;
  options.min_gradient = 0.0;
  const MotionEstimate one = Estimate(pair, GetParam(), options, 1);
  const MotionEstimate four = Estimate(pair, GetParam(), options, 4);
  EXPECT_GT(one.num_used, 10000);
  EXPECT_EQ(one.num_used, four.num_used);
  EXPECT_EQ(one.cur_from_prev.translation, four.cur_from_prev.translation);
  EXPECT_EQ(one.cur_from_prev.rotation.coeffs(),
            four.cur_from_prev.rotation.coeffs());
  EXPECT_EQ(one.covariance, four.covariance);
}

#if defined(__x86_64__)
TEST_P(DirectCostTest, InstructionSetsDifferByRounding) {
  using packed::InstructionSet;
  const DirectPair pair = SmallPair();
  InstructionSet& chosen = packed::ChosenInstructionSet();
  const InstructionSet best = chosen;
  const auto run = [&](InstructionSet set) {
    chosen = set;
    NormalEquations sum =
        Linearised(Make().get(), pair.data(), pair.cur_from_prev);
    chosen = best;
    return sum;
  };
  const NormalEquations narrow = run(InstructionSet::kBaseline);
  EXPECT_GT(narrow.cost, 0.0);
  for (const InstructionSet set :
       {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (set > best) continue;
    constexpr double kRounding = 1e-6;  // positions within a pixel are floats
    EXPECT_LE(SumsError(run(set), narrow), kRounding);
  }
}
#endif

INSTANTIATE_TEST_SUITE_P(All, DirectCostTest,
                         ::testing::ValuesIn(DirectCostNames()),
                         [](const auto& info) { return info.param; });

// Image positions (px) at which the rows of a cost are evaluated.
template <typename Residual>
std::vector<Eigen::Vector2d> PlacesOf(const DirectPair& pair) {
  const PackedColumns seen = SeenColumns<Residual>(
      InputOf(pair, 0, pair.cur_from_prev), PointsOf<Residual>(pair, 0, 3000));
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < seen.size; ++i) {
    const Eigen::Vector3d X(seen.values[i], seen.values[seen.stride + i],
                            seen.values[2 * seen.stride + i]);
    places.push_back(pair.cur.camera.Project(pair.cur_from_prev * X));
  }
  return places;
}

template <typename Residual>
void ExpectNoneIn(const DirectPair& pair, const Eigen::Vector2d& from,
                  const Eigen::Vector2d& to, const std::string& what) {
  const std::vector<Eigen::Vector2d> places = PlacesOf<Residual>(pair);
  EXPECT_GT(places.size(), 300u) << what;
  for (const Eigen::Vector2d& at : places) {
    EXPECT_FALSE((at.array() > from.array()).all() &&
                 (at.array() < to.array()).all())
        << what << " at " << at.transpose();
  }
}

TEST(SurfaceTest, HolesAndEdgesOfTheCurrentFrameTakeNoPart) {
  const cv::Rect block(100, 80, 60, 50);
  // Depths are read up to this distance.
  const Eigen::Vector2d from(100.0 - kSurfaceStep + 0.5,
                             80.0 - kSurfaceStep + 0.5);
  const Eigen::Vector2d to(159.0 + kSurfaceStep - 0.5,
                           129.0 + kSurfaceStep - 0.5);
  const DirectPair whole = SmallPair();
  EXPECT_GT(PlacesOf<ProjectivePlane>(whole).size(), 600u);
  for (const uint16_t hole : {uint16_t{0}, Frame::kNoDepth}) {
    DirectPair pair = SmallPair();
    pair.cur.frame.depth(block).setTo(hole);
    ExpectNoneIn<ProjectivePlane>(pair, from, to, "a hole");
    ExpectNoneIn<InverseDepth>(pair, from, to, "a hole");
  }
  // An object in front: its edges are no surface, and its surface is not the
  // expected one.
  DirectPair pair = SmallPair();
  pair.cur.frame.depth(block).setTo(5000);
  ExpectNoneIn<ProjectivePlane>(pair, from, to, "something in front");
  ExpectNoneIn<InverseDepth>(pair, from, to, "something in front");
}

TEST(SurfaceTest, HolesAndEdgesOfThePreviousFrameGiveNoPoints) {
  DirectPair pair = SmallPair();
  pair.cur_from_prev = Rigid3d();  // positions are in the previous frame
  pair.cur = pair.prev;
  pair.cur.Build();
  pair.prev.frame.depth(cv::Rect(100, 80, 30, 50)).setTo(0);
  pair.prev.frame.depth(cv::Rect(130, 80, 30, 50)).setTo(5000);
  pair.prev.Build();
  // The left and right edge of the object in front.
  for (const double u : {130.0, 160.0}) {
    ExpectNoneIn<ProjectivePlane>(pair, {u - kSurfaceStep + 0.5, 80.0},
                                  {u + kSurfaceStep - 1.5, 129.0}, "an edge");
  }
  ExpectNoneIn<Photometric>(pair, {99.5, 79.5}, {129.5, 129.5}, "a hole");
}

// Photometric cost that assumes equal exposure.
struct Unbrightened : Photometric {
  static constexpr bool kSeesBrightness = false;
};

TEST(BrightnessTest, GainAndBiasOfTheCurrentImageHardlyMatter) {
  const DirectPair pair = SmallPair();
  DirectPair brighter = SmallPair();
  brighter.cur.frame.gray.convertTo(brighter.cur.frame.gray, -1, 1.5, -20.0);
  brighter.cur.Build();
  DirectInput input = InputOf(brighter, 1, pair.cur_from_prev);
  EstimateBrightness(PointsOf<Photometric>(pair, 1, 4000), &input);
  EXPECT_NEAR(input.gain, 1.5, 0.03);
  EXPECT_NEAR(input.bias, -20.0, 3.0);
  const MotionEstimate plain = Estimate(pair, "photometric");
  const MotionEstimate changed = Estimate(brighter, "photometric");
  EXPECT_TRUE(changed.ok()) << changed.reason;
  const MotionError off = ErrorOf(changed.cur_from_prev, plain.cur_from_prev);
  const MotionVector sigma = plain.covariance.diagonal().cwiseSqrt();
  EXPECT_LE(off.translation, 0.5 * sigma.tail<3>().norm());
  EXPECT_LE(off.angle, 0.5 * sigma.head<3>().norm());
  // Without the brightness estimate the result must be wrong.
  MotionEstimate blind;
  Estimator(DirectEstimatorOptions(),
            std::make_unique<DirectCostOf<Unbrightened>>(DirectOptions()),
            ParseLoss("huber").Make(1))
      .Estimate(brighter.data(), Rigid3d(), &blind);
  const MotionError blind_off =
      ErrorOf(blind.cur_from_prev, plain.cur_from_prev);
  EXPECT_GT(blind_off.translation, 10.0 * off.translation);
}

TEST(DirectOptionsTest, CheckSaysWhatIsWrong) {
  const auto expect = [](void (*spoil)(DirectOptions*),
                         const std::string& part) {
    DirectOptions options;
    spoil(&options);
    EXPECT_THAT(options.Check(), testing::HasSubstr(part));
    ExpectInputError([&] { MakeDirectCost("photometric", options); }, {part});
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(DirectOptions().Check(), "");
  expect([](auto* o) { o->max_points = -1; },
         "max_points must not be negative");
  expect([](auto* o) { o->min_gradient = -1.0; }, "min_gradient");
  expect([](auto* o) { o->min_gradient = kNaN; }, "min_gradient");
  expect([](auto* o) { o->min_depth = 0.0; }, "depth");
  expect([](auto* o) { o->max_depth = 0.2; }, "depth");
  expect([](auto* o) { o->max_depth = kNaN; }, "depth");
  expect([](auto* o) { o->num_levels = 0; }, "level");
  expect([](auto* o) { o->num_levels = 17; }, "num_levels must be 1 to 16");
  expect([](auto* o) { o->finest_level = -1; }, "level");
  expect([](auto* o) { o->information_factor = -1.0; }, "information_factor");
  expect([](auto* o) { o->information_factor = kNaN; }, "information_factor");
  expect([](auto* o) { o->information_factor = 1.1; }, "information_factor");
}

TEST(DirectCostFactoryTest, UnknownNamesListWhatThereIs) {
  EXPECT_EQ(MakeDirectCost("mahalanobis_point", {}), nullptr);
  ExpectInputError(
      [] { MakeDirectCosts("photometry"); },
      {"'photometry'", "photometric", "inverse_depth", "projective_plane"});
  ExpectInputError([] { MakeDirectCosts("photometric", "hubert"); },
                   {"'hubert'", "huber"});
  ExpectInputError([] { MakeDirectCosts("photometric", "huber,tukey"); },
                   {"one for all or one for each"});
  EXPECT_EQ(MakeDirectCosts().size(), 2u);
}

}  // namespace
}  // namespace rgbd_pose
