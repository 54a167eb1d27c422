#include "frontend/places/place_checker.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_buildings.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kDegree = M_PI / 180.0;

// A frame of a tour and all that is made of it.
struct View {
  Rigid3d world_from_cam;
  std::unique_ptr<const PreparedFrame> frame;
  std::unique_ptr<FeatureSet> features;
  PlaceFeatures place;
};

// Views of a simulated tour, small ones, second by second.
class Tour {
 public:
  explicit Tour(const std::string& name)
      : dataset_(Options(name)), checker_(MakeChecker(dataset_.camera())) {}

  View At(int second) {
    View view;
    view.world_from_cam = dataset_.WorldFromCam(second);
    view.frame = checker_.frontend().Prepare(dataset_.Read(second));
    view.features = checker_.frontend().Detect(*view.frame);
    view.place = DescribeKeyframe(*view.frame, dataset_.camera().camera, {});
    return view;
  }

  PlaceCheck Check(const View& ref, const View& cur) {
    return checker_.Check(ref.place, *ref.features, cur.place, *cur.frame);
  }
  PlaceChecker& checker() { return checker_; }

 private:
  static SyntheticOptions Options(const std::string& name) {
    SyntheticOptions options;
    options.scene = name;
    options.path = name;
    options.frames = 120;
    options.rate_hz = 1.0;
    options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
    return options;
  }
  static PlaceChecker MakeChecker(const RgbdCamera& camera) {
    FrontendOptions options;
    options.camera = camera.camera;
    return PlaceChecker(MakeFrontend("patch", options),
                        Estimator({}, MakeRobustCosts()));
  }

  SyntheticDataset dataset_;
  PlaceChecker checker_;
};

Rigid3d CurFromRef(const View& ref, const View& cur) {
  return cur.world_from_cam.Inverse() * ref.world_from_cam;
}

void ExpectMotion(const PlaceCheck& check, const Rigid3d& cur_from_ref) {
  ASSERT_TRUE(check.ok) << check.reason;
  const Rigid3d error = check.cur_from_ref * cur_from_ref.Inverse();
  EXPECT_LT(error.translation.norm(), 0.01);  // m
  EXPECT_LT(error.Angle(), 0.3 * kDegree);
  EXPECT_GE(check.num_inliers, 60);
  // It knows how far it is off: chi^2 of 6 degrees stays below 22.5 in 999 of
  // 1000 cases; of images as small as these it is 2.5 times as much on average.
  MotionVector off;
  const Eigen::AngleAxisd turn(error.rotation);
  off << turn.axis() * turn.angle(), check.cur_from_ref.Inverse().translation -
                                         cur_from_ref.Inverse().translation;
  EXPECT_LT(off.dot(check.covariance.ldlt().solve(off)), 2.5 * 22.5);
}

TEST(PlaceCheckerTest, FindsRevisits) {
  for (const auto& [name, round] :
       {std::pair("table", 56), std::pair("two_rooms", 57)}) {
    Tour tour(name);
    for (const int second : {0, 1, 4}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(second));
      const View ref = tour.At(second);
      const View cur = tour.At(second + round + 1);
      ExpectMotion(tour.Check(ref, cur), CurFromRef(ref, cur));
    }
  }
}

// The other side of a room, the other room: nothing is shared but the style.
TEST(PlaceCheckerTest, RefusesOtherPlaces) {
  Tour tour("two_rooms");
  std::vector<View> views;
  for (const int second : {1, 12, 20, 30, 43, 50}) {
    views.push_back(tour.At(second));
  }
  int refused = 0;
  for (const View& ref : views) {
    for (const View& cur : views) {
      const Rigid3d motion = CurFromRef(ref, cur);
      if (motion.Angle() < 60.0 * kDegree) continue;  // may see the same
      const PlaceCheck check = tour.Check(ref, cur);
      EXPECT_FALSE(check.ok);
      EXPECT_FALSE(check.reason.empty());
      // Taken for each other by whoever looks from where they are.
      const PlaceCheck near =
          tour.checker().CheckNear(Rigid3d(), *ref.features, *cur.frame);
      EXPECT_FALSE(near.ok);
      EXPECT_FALSE(near.reason.empty());
      ++refused;
    }
  }
  EXPECT_GE(refused, 12);
}

TEST(PlaceCheckerTest, FromAGuessItIsRightOrRefuses) {
  Tour tour("table");
  const View ref = tour.At(2);
  const View cur = tour.At(59);
  const Rigid3d truth = CurFromRef(ref, cur);
  const auto check = [&](double x) {
    Rigid3d guess = truth;
    guess.translation.x() += x;
    return tour.checker().CheckNear(guess, *ref.features, *cur.frame);
  };
  ExpectMotion(check(0.0), truth);
  ExpectMotion(check(0.05), truth);
  for (const double x : {0.5, -0.5, 2.0}) {
    const PlaceCheck far = check(x);
    if (far.ok) ExpectMotion(far, truth);
  }
}

// The same picture and the same depths at two places: no look at two frames can
// tell them apart. That is for the graph to do.
TEST(PlaceCheckerTest, TakesTwinsForEachOther) {
  Tour tour("twin_corridors");
  const View ref = tour.At(15);  // in the first corridor
  // Where the same is seen of the second.
  View cur;
  Rigid3d shift;
  shift.translation.x() = kTwinShift;
  double nearest = 1e9;
  for (int second = 36; second < 46; ++second) {
    View view = tour.At(second);
    const double distance = (view.world_from_cam.translation -
                             (shift * ref.world_from_cam).translation)
                                .norm();
    if (distance > nearest) continue;
    nearest = distance;
    cur = std::move(view);
  }
  const PlaceCheck check = tour.Check(ref, cur);
  ExpectMotion(check,
               cur.world_from_cam.Inverse() * shift * ref.world_from_cam);
}

TEST(PlaceCheckerTest, TheSameFramesGiveTheSameBytes) {
  PlaceCheck checks[2];
  for (PlaceCheck& check : checks) {
    Tour tour("table");
    check = tour.Check(tour.At(3), tour.At(59));
  }
  ASSERT_TRUE(checks[0].ok) << checks[0].reason;
  EXPECT_EQ(checks[0].cur_from_ref.translation,
            checks[1].cur_from_ref.translation);
  EXPECT_EQ(checks[0].cur_from_ref.rotation.coeffs(),
            checks[1].cur_from_ref.rotation.coeffs());
  EXPECT_EQ(checks[0].covariance, checks[1].covariance);
}

TEST(PlaceCheckerTest, RefusesOptionsWithoutSense) {
  const auto refuse = [](const PlaceCheckerOptions& options, const char* what) {
    FrontendOptions images;
    images.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
    ExpectInputError(
        [&] {
          PlaceChecker(MakeFrontend("patch", images),
                       Estimator({}, MakeRobustCosts()), options);
        },
        {what});
  };
  refuse({2, 0.5, 3.0}, "min_inliers");
  refuse({60, 1.5, 3.0}, "min_inlier_share");
  refuse({60, std::nan(""), 3.0}, "min_inlier_share");
  refuse({60, 0.5, 0.0}, "max_sigma");
}

}  // namespace
}  // namespace rgbd_pose
