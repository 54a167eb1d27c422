// When the row that shows a point is exposed, and where the point is then.

#include "costs/direct/lane_image.h"

#include <gtest/gtest.h>

#include <vector>

#include "costs/cost_list.h"
#include "frontend/frame/image_pyramid.h"
#include "frontend/frame/observe.h"
#include "tests/support/exact_twist.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

enum class TestLens { kNone, kPlumbBob, kRational, kFisheye };
constexpr TestLens kTestLenses[] = {TestLens::kNone, TestLens::kPlumbBob,
                                    TestLens::kRational, TestLens::kFisheye};

Camera TestCamera(TestLens lens) {
  Camera camera = {320, 240, 262.5, 262.5, 159.5, 119.5};
  if (lens == TestLens::kFisheye) {
    camera.SetDistortion(LensModel::kEquidistant, {-0.02, 0.01, 0.0, 0.001});
  } else if (lens == TestLens::kRational) {
    camera.SetDistortion(LensModel::kRational,
                         {0.4, -0.2, 0.002, -0.003, 0.1, 0.3, -0.1, 0.05});
  } else if (lens == TestLens::kPlumbBob) {
    camera.SetDistortion(LensModel::kRational, {0.1, -0.2, 0.002, -0.003, 0.1});
  }
  return camera;
}

const std::vector<Shutter> kShutters = {
    {-0.0075, 0.028}, {0.01, -0.03}, {0.015, 0.0}, {0.0, 0.02}};
// The last one accelerates as a hand does.
const std::vector<Twist> kTwists = {
    {{0.8, -0.5, 0.6}, {0.0, 0.0, 0.0}},
    {{0.0, 0.0, 0.0}, {-0.3, 0.5, 0.4}},
    {{-0.5, 0.7, 0.4}, {0.6, -0.4, -0.5}},
    {{-0.5, 0.7, 0.4}, {0.6, -0.4, -0.5}, {5.0, 7.0, -4.0}, {-2.5, 3.0, 2.0}}};

std::vector<Vector3d> Points(const Camera& camera) {
  std::vector<Vector3d> points;
  for (int v = 20; v < 230; v += 40) {
    for (int u = 20; u < 310; u += 50) {
      points.push_back(camera.Unproject({u, v}, 0.8 + 0.01 * u));
    }
  }
  return points;
}

// MoveToRow() takes the point's vertical image speed as constant. The speed
// varies over the image, which causes small errors for motions of 10 px.
constexpr double kPixelTolerance = 0.05;

TEST(MoveToRowTest, IsWhereIterationEnds) {
  for (const TestLens lens : kTestLenses) {
    const Camera camera = TestCamera(lens);
    for (const Shutter& shutter : kShutters) {
      for (const Twist& twist : kTwists) {
        double farthest = 0.0;
        int count = 0;
        for (const Vector3d& point : Points(camera)) {
          Vector3d moved;
          MoveToRow(camera, camera.MakeLens(), shutter, twist, point.data(),
                    moved.data());
          Vector2d pixel = camera.Project(point);
          const Vector2d at_stamp = pixel;
          for (int i = 0; i < 20; ++i) {
            pixel = camera.Project(twist.MovedPoint(
                point, shutter.RowTime(pixel.y(), camera.height)));
          }
          EXPECT_LT((camera.Project(moved) - pixel).norm(), kPixelTolerance);
          farthest = std::max(farthest, (pixel - at_stamp).norm());
          if (count++ % 5 != 0) continue;  // the exact way takes long
          EXPECT_LT((ExactlySeen(camera, shutter, twist, point) - pixel).norm(),
                    kPixelTolerance);
        }
        EXPECT_GT(farthest, 1.0) << "nothing moves";
      }
    }
  }
}

// A level of half the height takes twice as long for each row.
TEST(MoveToRowTest, TimesAreTheSameAtEveryLevel) {
  const Camera camera = TestCamera(TestLens::kNone);
  const Camera half = CameraOfLevel(camera, 1);
  for (const Vector3d& point : Points(camera)) {
    Vector3d moved, moved_there;
    MoveToRow(camera, camera.MakeLens(), kShutters[0], kTwists[2], point.data(),
              moved.data());
    MoveToRow(half, half.MakeLens(), kShutters[0], kTwists[2], point.data(),
              moved_there.data());
    EXPECT_LT((moved - moved_there).norm(), 1e-12);  // rounding
  }
}

// Costs read the image where ImagePoint() finds the features.
TEST(MoveToRowTest, CostsLookWhereImagePointSays) {
  const Rigid3d motion(Eigen::Quaterniond(Eigen::AngleAxisd(
                           0.02, Vector3d(1, 2, -1).normalized())),
                       {0.02, -0.01, 0.03});
  for (const TestLens lens : kTestLenses) {
    FrameView view;
    view.levels = {{{nullptr, 320, 240, 320}, TestCamera(lens)}};
    const Camera& camera = view.levels[0].camera;
    DirectInput input;
    input.cur = &view;
    input.R = motion.rotation.toRotationMatrix();
    input.t = motion.translation;
    input.lens = camera.MakeLens();
    input.moves_color = input.moves_depth = true;
    for (const Twist& twist : kTwists) {
      const Shutter& color = kShutters[0];
      const Shutter& depth = kShutters[1];
      view.timing = {color, depth, twist};
      for (const Vector3d& prev : Points(camera)) {
        double point[7] = {prev.x(), prev.y(), prev.z(), 0.0, 0.0, 0.5, 0.01};
        const Vector3d q = motion * prev;
        ProjectedPoint<double> place;
        Photometric::Locate(input, point, &place);
        EXPECT_LT(
            (Vector2d(place.u, place.v) - ImagePoint(camera, view.timing, q))
                .norm(),
            kPixelTolerance);
        EXPECT_NEAR(place.z, q.z(), 1e-12);  // at the stamp
        ProjectivePlane::Locate(input, point, &place);
        EXPECT_LT((Vector2d(place.u, place.v) -
                   ImagePoint(camera, {depth, {}, twist}, q))
                      .norm(),
                  kPixelTolerance);
      }
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
