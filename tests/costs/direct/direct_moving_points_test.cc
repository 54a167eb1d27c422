// The points of a frame with rolling shutters are where those of the same frame
// with global shutters are.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/util/quantile.h"
#include "costs/direct/direct_points.h"
#include "tests/support/direct_pair.h"
#include "tests/support/rolling_frame.h"

namespace rgbd_pose {
namespace {

constexpr int kIndex = 30;
constexpr double kBorder = 20.0;  // px, in view in all images

using Select = void (*)(const FrameView&, int, const DirectOptions&,
                        PackedColumns*);

PackedColumns PointsOf(Select select, const FrameView& view, int level) {
  DirectOptions options;
  options.max_points = 1500;
  PackedColumns points;
  select(view, level, options, &points);
  return points;
}

Eigen::Vector3d VectorAt(const PackedColumns& points, int first, int i) {
  const auto value = [&](int k) {
    return points.values[(first + k) * points.stride + i];
  };
  return {value(0), value(1), value(2)};
}

double GrayAt(const ImageView<uint8_t>& gray, const Eigen::Vector2d& at) {
  const int u = static_cast<int>(at.x()), v = static_cast<int>(at.y());
  const double right = at.x() - u, down = at.y() - v;
  const auto row = [&](int y) {
    return (1.0 - right) * gray.At(u, y) + right * gray.At(u + 1, y);
  };
  return (1.0 - down) * row(v) + down * row(v + 1);
}

// How far points are from what another frame of one moment shows where they
// are: relative depths, gray levels.
struct Off {
  std::vector<double> depth, gray;
};

Off OffFrom(const DirectFrame& expected, int level, bool has_gray,
            const PackedColumns& points) {
  Off off;
  for (int i = 0; i < points.size; ++i) {
    const Eigen::Vector3d X = VectorAt(points, 0, i);
    const Eigen::Vector2d pixel = expected.camera.Project(X);
    if (!expected.camera.Contains(pixel, kBorder)) continue;
    const double z =
        expected.frame.DepthAt(static_cast<int>(std::lround(pixel.x())),
                               static_cast<int>(std::lround(pixel.y())));
    off.depth.push_back(z > 0.0 ? std::abs(X.z() / z - 1.0) : 1.0);
    if (!has_gray) continue;
    const FrameView::Level& image = expected.view.levels[level];
    off.gray.push_back(std::abs(GrayAt(image.gray, image.camera.Project(X)) -
                                points.values[4 * points.stride + i]));
  }
  return off;
}

// A rolling frame, the same without its velocity, and what is seen `later` (s)
// than the time stamp, from where points refer to.
struct Views {
  explicit Views(double later, int index = kIndex,
                 const std::string& path = "handheld")
      : camera(HandheldOptions().camera.camera),
        moving(HandheldFrame(index, {-0.0075, 0.028}, {-0.018, 0.028}, path),
               camera),
        expected(HandheldFrame(index, {later, 0.0}, {later, 0.0}, path),
                 camera),
        unmoved(moving) {
    expected.frame.twist.reset();
    expected.Build();
    unmoved.frame.twist.reset();
    unmoved.Build();
    moving.view.reference_from_stamp = moving.frame.twist->MotionDuring(later);
  }

  Camera camera;
  DirectFrame moving, expected, unmoved;
};

TEST(MovingPointsTest, TexturedOnesShowWhatAGlobalShutterSees) {
  for (const double later : {0.0, 0.004}) {
    const Views views(later);
    for (const int level : {0, 1, 2}) {
      const auto off_of = [&](const FrameView& view) {
        return OffFrom(views.expected, level, true,
                       PointsOf(&TexturedPoints, view, level));
      };
      const Off off = off_of(views.moving.view);
      const Off before = off_of(views.unmoved.view);
      EXPECT_GT(off.gray.size(), 0.9 * before.gray.size());
      EXPECT_LT(Median(off.depth), 0.0015);
      EXPECT_LT(Quantile(off.depth, 0.9), 0.005);  // except at edges
      EXPECT_GT(Median(before.depth), 5.0 * Median(off.depth));
      // Half a pixel where gray levels change most, sharply at level 0.
      EXPECT_LT(Median(off.gray), 2.0);
      EXPECT_LT(Quantile(off.gray, 0.9), level == 0 ? 12.0 : 4.0);
      EXPECT_GT(Quantile(before.gray, 0.9), 3.0 * Quantile(off.gray, 0.9));
    }
  }
}

// How far the planes of a view are from those of another one that are closest
// to them in the image, relative to their size.
std::vector<double> OffFromPlanes(const Camera& camera,
                                  const PackedColumns& planes,
                                  const FrameView& view) {
  std::vector<double> off;
  const PackedColumns points = PointsOf(&SmoothPoints, view, 0);
  for (int i = 0; i < points.size; ++i) {
    const Eigen::Vector3d X = VectorAt(points, 0, i);
    const Eigen::Vector3d N = VectorAt(points, 3, i);
    EXPECT_NEAR(N.dot(X), 1.0, 1e-12);
    double nearest = 8.0;  // px
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    for (int k = 0; k < planes.size; ++k) {
      const double distance =
          (camera.Project(VectorAt(planes, 0, k)) - camera.Project(X)).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      expected = VectorAt(planes, 3, k);
    }
    if (!expected.isZero(0.0)) {
      off.push_back((N - expected).norm() / expected.norm());
    }
  }
  return off;
}

// Those of a turn that reaches 300 degrees/s within a tenth of a second, in the
// middle of that. The limits are half of what they err at its mean velocity.
TEST(MovingPointsTest, KnowHowATurnStarts) {
  const Views views(0.0, 36, "whip_pan");
  const Off textured = OffFrom(views.expected, 0, /*has_gray=*/true,
                               PointsOf(&TexturedPoints, views.moving.view, 0));
  EXPECT_LT(Median(textured.depth), 0.0015);
  EXPECT_LT(Quantile(textured.depth, 0.9), 0.01);
  EXPECT_LT(Median(textured.gray), 2.0);
  EXPECT_LT(Quantile(textured.gray, 0.9), 15.0);
  const Off smooth = OffFrom(views.expected, 0, /*has_gray=*/false,
                             PointsOf(&SmoothPoints, views.moving.view, 0));
  EXPECT_LT(Median(smooth.depth), 0.0014);
  EXPECT_LT(Quantile(smooth.depth, 0.9), 0.008);
  const PackedColumns planes = PointsOf(&SmoothPoints, views.expected.view, 0);
  EXPECT_LT(Median(OffFromPlanes(views.camera, planes, views.moving.view)),
            0.01);
}

TEST(MovingPointsTest, PlanesAreThoseOfAGlobalShutter) {
  for (const double later : {0.0, 0.004}) {
    const Views views(later);
    const PackedColumns planes =
        PointsOf(&SmoothPoints, views.expected.view, 0);
    const auto off_of = [&](const FrameView& view) {
      return OffFromPlanes(views.camera, planes, view);
    };
    const std::vector<double> off = off_of(views.moving.view);
    const std::vector<double> before = off_of(views.unmoved.view);
    EXPECT_GT(off.size(), 0.9 * before.size());
    // From row to row the motion bends a surface, by some hundredths.
    EXPECT_LT(Quantile(off, 0.8), 0.06);
    EXPECT_GT(Quantile(before, 0.8), 3.0 * Quantile(off, 0.8));
    const auto depth_of = [&](const FrameView& view) {
      return OffFrom(views.expected, 0, /*has_gray=*/false,
                     PointsOf(&SmoothPoints, view, 0))
          .depth;
    };
    const std::vector<double> depth = depth_of(views.moving.view);
    EXPECT_LT(Median(depth), 0.002);
    EXPECT_LT(Quantile(depth, 0.9), 0.008);
    EXPECT_GT(Quantile(depth_of(views.unmoved.view), 0.9),
              3.0 * Quantile(depth, 0.9));
  }
}

// All rows at once, but not at the stamp: nothing is bent.
TEST(MovingPointsTest, PlanesTurnWithTheCamera) {
  const Camera camera = HandheldOptions().camera.camera;
  DirectFrame late(HandheldFrame(kIndex, {}, {0.03, 0.0}), camera);
  const DirectFrame expected(HandheldFrame(kIndex, {}, {}), camera);
  const PackedColumns planes = PointsOf(&SmoothPoints, expected.view, 0);
  const double off = Median(OffFromPlanes(camera, planes, late.view));
  late.frame.twist.reset();
  late.Build();
  const double before = Median(OffFromPlanes(camera, planes, late.view));
  EXPECT_LT(off, 0.005);
  EXPECT_GT(before, 4.0 * off);
}

// Axes elsewhere change nothing but the axes.
TEST(MovingPointsTest, TheAxesOfTheReferenceMoveAllAlike) {
  Views views(0.004);
  const Rigid3d moved = views.moving.view.reference_from_stamp;
  FrameView at_stamp = views.moving.view;
  at_stamp.reference_from_stamp = Rigid3d();
  for (const Select select : {&TexturedPoints, &SmoothPoints}) {
    const PackedColumns here = PointsOf(select, at_stamp, 1);
    const PackedColumns there = PointsOf(select, views.moving.view, 1);
    ASSERT_EQ(here.size, there.size);
    ASSERT_GT(here.size, 300);
    for (int i = 0; i < here.size; ++i) {
      const Eigen::Vector3d X = moved * VectorAt(here, 0, i);
      EXPECT_LT((VectorAt(there, 0, i) - X).norm(), 1e-12);
      if (select != &SmoothPoints) continue;
      Eigen::Vector3d N = moved.rotation * VectorAt(here, 3, i);
      N /= N.dot(X);
      EXPECT_LT((VectorAt(there, 3, i) - N).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
