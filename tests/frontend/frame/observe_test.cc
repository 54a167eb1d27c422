// A wall seen with a rolling shutter by a moving camera.

#include "frontend/frame/observe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/exact_twist.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Camera SmallCamera(bool is_distorted) {
  Camera camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
  if (is_distorted) {
    camera.k1 = 0.1;
    camera.k2 = -0.2;
    camera.p1 = 0.002;
    camera.p2 = -0.003;
  }
  return camera;
}

// The wall normal . X = -distance, in camera axes at the stamp, about 2 m away.
const Vector3d kNormal = Vector3d(0.3, -0.2, -1.0).normalized();
constexpr double kDistance = 1.9;

Vector3d WallPoint(const Camera& camera, const Vector2d& ideal) {
  const Vector3d ray = camera.Ray(ideal.x(), ideal.y());
  return ray * (-kDistance / kNormal.dot(ray));
}

Frame FrameOfWall(const Camera& camera, const FrameTiming& timing) {
  Frame frame;
  frame.depth_scale = 20000.0;  // 0.05 mm steps, no noise
  frame.gray = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(0));
  frame.depth = cv::Mat(camera.height, camera.width, CV_16UC1);
  frame.color_shutter = timing.color;
  frame.depth_shutter = timing.depth;
  frame.twist = timing.twist;
  for (int v = 0; v < camera.height; ++v) {
    const Rigid3d row_from_stamp =
        ExactMotion(timing.twist, timing.depth.RowTime(v, camera.height));
    const Vector3d normal = row_from_stamp.rotation * kNormal;
    const double distance = kDistance - normal.dot(row_from_stamp.translation);
    for (int u = 0; u < camera.width; ++u) {
      const Vector3d ray = camera.Unproject({u, v}, 1.0);
      frame.depth.at<uint16_t>(v, u) = static_cast<uint16_t>(
          std::lround(frame.depth_scale * -distance / normal.dot(ray)));
    }
  }
  return frame;
}

const Twist kTurning = {{0.7, -0.6, 0.5}, {0.0, 0.0, 0.0}};
const Twist kSliding = {{0.0, 0.0, 0.0}, {0.4, -0.5, 0.6}};
const Twist kMoving = kTurning + kSliding;
const Twist kShaking = {
    {0.7, -0.6, 0.5}, {0.4, -0.5, 0.6}, {12.0, 15.0, -10.0}, {-5.0, 6.0, 4.0}};

// Colour shutter only, depth shutter only, both, and last row first.
std::vector<FrameTiming> Timings() {
  std::vector<FrameTiming> timings;
  for (const Twist& twist : {kTurning, kSliding, kMoving, kShaking}) {
    for (const auto& [color, depth] : std::vector<std::pair<Shutter, Shutter>>{
             {{-0.0075, 0.028}, {-0.018, 0.028}},
             {{0.006, -0.02}, {0.015, -0.03}},
             {{0.0, 0.03}, {0.0, 0.0}},
             {{0.0, 0.0}, {-0.02, 0.0}},
             {{0.01, 0.0}, {0.0, -0.025}}}) {
      timings.push_back({color, depth, twist});
    }
  }
  return timings;
}

// Ideal pixels, far enough from the border to be in view at any row's time.
std::vector<Vector2d> Grid() {
  std::vector<Vector2d> grid;
  for (int v = 30; v <= 210; v += 36) {
    for (int u = 30; u <= 290; u += 52) grid.emplace_back(u + 0.3, v + 0.6);
  }
  return grid;
}

// The row is read at a position with an error of 1 % of the motion of 10 px.
// Terms beyond second order move points by 0.002 px at a rotation of 1 rad/s.
constexpr double kPixelTolerance = 0.03;

TEST(ObserveTest, SeesAllAsAtTheStamp) {
  for (const bool is_distorted : {false, true}) {
    const Camera camera = SmallCamera(is_distorted);
    for (const FrameTiming& timing : Timings()) {
      const Frame frame = FrameOfWall(camera, timing);
      Frame ignored = frame;
      ignored.twist.reset();
      double largest = 0.0, largest_depth = 0.0;
      for (const Vector2d& ideal : Grid()) {
        const Vector3d point = WallPoint(camera, ideal);
        const Vector2d seen =
            ExactlySeen(camera, timing.color, timing.twist, point);
        const Observation o =
            Observe(frame, camera, seen.x(), seen.y(), 0.5, {});
        EXPECT_NEAR(o.u, ideal.x(), kPixelTolerance);
        EXPECT_NEAR(o.v, ideal.y(), kPixelTolerance);
        // Half of a unit, plus a slope of 0.3 over some hundredths of a pixel.
        EXPECT_NEAR(o.depth, point.z(), 0.0005);
        EXPECT_GT(o.sigma_depth, 0.0);
        const Observation as_it_is =
            Observe(ignored, camera, seen.x(), seen.y(), 0.5, {});
        largest = std::max(largest,
                           (Vector2d(as_it_is.u, as_it_is.v) - ideal).norm());
        largest_depth =
            std::max(largest_depth, std::abs(as_it_is.depth - point.z()));
      }
      EXPECT_GT(largest + 200.0 * largest_depth, 1.5) << "nothing to undo";
    }
  }
}

// The wall's motion from row to row bends it, which affects the normal. Hence
// the readout is short here.
TEST(ObserveTest, TurnsNormals) {
  const Camera camera = SmallCamera(false);
  const FrameTiming timing = {{0.0, 0.0}, {0.06, 0.001}, kTurning};
  const Frame frame = FrameOfWall(camera, timing);
  Frame ignored = frame;
  ignored.twist.reset();
  for (const Vector2d& ideal : Grid()) {
    const auto off = [&](const Frame& seen) {
      const Observation o =
          Observe(seen, camera, ideal.x(), ideal.y(), 0.5, {});
      return std::acos(std::min(1.0, o.normal.dot(kNormal)));
    };
    // The square of the angle of rotation, and the rounding of depths.
    EXPECT_LT(off(frame), 0.006);
    // The full angle, except for the rotation about the normal itself.
    EXPECT_GT(off(ignored), 0.04);
  }
}

TEST(ObserveTest, ImagePointIsTheOtherWayRound) {
  for (const bool is_distorted : {false, true}) {
    const Camera camera = SmallCamera(is_distorted);
    for (const FrameTiming& timing : Timings()) {
      for (const Vector2d& ideal : Grid()) {
        const Vector3d point = WallPoint(camera, ideal);
        const Vector2d found = ImagePoint(camera, timing, point);
        const Vector2d exact =
            ExactlySeen(camera, timing.color, timing.twist, point);
        EXPECT_LT((found - exact).norm(), kPixelTolerance);
      }
    }
  }
}

void ExpectSame(const Observation& a, const Observation& b) {
  EXPECT_EQ(a.u, b.u);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.sigma_px, b.sigma_px);
  EXPECT_EQ(a.sigma_depth, b.sigma_depth);
  EXPECT_EQ(a.normal, b.normal);
}

TEST(ObserveTest, WhereNothingIsKnownOrToBeDoneAllIsAsItIs) {
  const Camera camera = SmallCamera(true);
  const Frame rolling = FrameOfWall(camera, Timings()[0]);
  Frame plain = rolling;
  plain.twist.reset();
  plain.color_shutter = plain.depth_shutter = Shutter();
  Frame unknown = rolling;
  unknown.twist.reset();
  Frame global = plain;
  global.twist = kMoving;
  for (const Vector2d& pixel : Grid()) {
    const auto observe = [&](const Frame& frame) {
      return Observe(frame, camera, pixel.x(), pixel.y(), 0.5, {});
    };
    const Observation expected = observe(plain);
    EXPECT_GT(expected.depth, 0.0);
    ExpectSame(observe(unknown), expected);
    ExpectSame(observe(global), expected);
    const Vector3d point = camera.Unproject(pixel, 2.0);
    EXPECT_EQ(ImagePoint(camera, unknown.Timing(), point),
              camera.Project(point));
    EXPECT_EQ(ImagePoint(camera, global.Timing(), point),
              camera.Project(point));
  }
}

// No depth or normal is made up where depth is missing.
TEST(ObserveTest, WithoutDepthThePixelIsMovedAsThatOfARoom) {
  const Camera camera = SmallCamera(false);
  const FrameTiming timing = {{0.02, 0.0}, {0.02, 0.0}, kTurning};
  Frame frame = FrameOfWall(camera, timing);
  frame.depth.setTo(0);
  const Vector3d point = camera.Unproject({100.0, 80.0}, 2.0);
  const Vector2d seen = ExactlySeen(camera, timing.color, timing.twist, point);
  const Observation o = Observe(frame, camera, seen.x(), seen.y(), 0.5, {});
  EXPECT_EQ(o.depth, 0.0);
  EXPECT_TRUE(o.normal.isZero(0.0));
  EXPECT_LT((Vector2d(o.u, o.v) - Vector2d(100.0, 80.0)).norm(),
            kPixelTolerance);
}

TEST(ObserveTest, TheLargestFlowIsThatOfTheMostDistantRow) {
  const Camera camera = SmallCamera(false);
  const FrameTiming timing = {{-0.01, 0.02}, {0.005, -0.01}, {}};
  constexpr double kTolerance = 1e-12;  // rounding
  Twist turning, sliding;
  turning.angular.y() = 0.5;
  sliding.linear.z() = 0.5;
  EXPECT_NEAR(LargestFlow(camera, timing, turning), 0.02 * 262.5 * 0.5,
              kTolerance);
  EXPECT_NEAR(LargestFlow(camera, timing, sliding), 0.02 * 262.5 * 0.25,
              kTolerance);
  EXPECT_EQ(LargestFlow(camera, {}, kMoving), 0.0);
}

}  // namespace
}  // namespace rgbd_pose
