// Which pixels become points, checked with another implementation, and the data
// of each point.

#include "costs/direct/direct_points.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "frontend/frame/image_pyramid.h"

namespace rgbd_pose {
namespace {

constexpr double kUnitsPerMetre = 20000.0;

// Images with two levels whose pixels are all set by a test.
struct PaintedFrame {
  std::vector<uint8_t> gray, half_gray;
  std::vector<uint16_t> depth;
  FrameView view;

  PaintedFrame(int width, int height)
      : gray(width * height), half_gray(gray.size() / 4), depth(gray.size()) {
    Camera camera;
    camera.fx = 61.0;
    camera.fy = 67.0;
    camera.cx = 0.45 * width;
    camera.cy = 0.55 * height;
    camera.width = width;
    camera.height = height;
    view.levels = {{{gray.data(), width, height, width}, camera},
                   {{half_gray.data(), width / 2, height / 2, width / 2},
                    CameraOfLevel(camera, 1)}};
    view.depth = {depth.data(), width, height, width};
    view.depth_scale = kUnitsPerMetre;
    view.depth_noise.constant = 0.0;
    view.depth_noise.quadratic = 0.002;
    view.depth_noise.centre = 0.0;
  }

  PaintedFrame(const PaintedFrame&) = delete;
  PaintedFrame& operator=(const PaintedFrame&) = delete;

  // A plane: 1 / z = a + b u + c v.
  void PaintPlane(double a, double b, double c) {
    for (int v = 0; v < view.depth.height; ++v) {
      for (int u = 0; u < view.depth.width; ++u)
        SetDepth(u, v, 1.0 / (a + b * u + c * v));
    }
  }
  void SetDepth(int u, int v, double z) {
    depth[v * view.depth.width + u] =
        static_cast<uint16_t>(std::lround(z * kUnitsPerMetre));
  }
};

// Noise in patches: some cells steep, some flat; some depths missing or torn.
void PaintAtRandom(PaintedFrame* frame) {
  std::mt19937 random(3);
  const auto draw = [&](int n) { return static_cast<int>(random() % n); };
  frame->PaintPlane(0.7, 0.002, -0.001);
  for (int level = 0; level < 2; ++level) {
    std::vector<uint8_t>& gray = level == 0 ? frame->gray : frame->half_gray;
    const int width = frame->view.levels[level].gray.width;
    for (size_t i = 0; i < gray.size(); ++i) {
      const int patch =
          static_cast<int>(i % width) / 16 + static_cast<int>(i) / width / 16;
      gray[i] = static_cast<uint8_t>(100 + draw(patch % 3 == 0 ? 12 : 40));
    }
  }
  for (int i = 0; i < 60; ++i) {
    const int at = draw(static_cast<int>(frame->depth.size()));
    frame->depth[at] = i % 2 == 0 ? 0 : frame->depth[at] + 900;
  }
}

std::vector<Eigen::VectorXd> Rows(const PackedColumns& points, int columns) {
  std::vector<Eigen::VectorXd> rows(points.size, Eigen::VectorXd(columns));
  for (int i = 0; i < points.size; ++i) {
    for (int k = 0; k < columns; ++k) {
      rows[i][k] = points.values[k * points.stride + i];
    }
  }
  return rows;
}

// The expected point at a pixel, if the pixel is a candidate, and its gradient.
struct Candidate {
  Eigen::VectorXd point;
  int square = 0;  // squared gradient over two pixels
};

// The depth at (x, y) by the plane through those of the 3 x 3 pixels around
// (column, row) that have one: 1 / z = p . (1, u, v). 0: too many have none, or
// they are on two surfaces.
double DepthOfPlane(const FrameView& view, int column, int row, double x,
                    double y) {
  std::vector<double> known;
  Eigen::MatrixXd rows(0, 3);
  Eigen::VectorXd right(0);
  for (int k = 0; k < 9; ++k) {
    const int u = column + k % 3 - 1, v = row + k / 3 - 1;
    const double z = view.DepthAt(u, v);
    if (z == 0.0) continue;
    known.push_back(z);
    rows.conservativeResize(known.size(), Eigen::NoChange);
    right.conservativeResize(known.size());
    rows.bottomRows<1>() << 1.0, u, v;
    right.tail<1>() << 1.0 / z;
  }
  if (known.size() < 7) return 0.0;
  const auto [low, high] = std::minmax_element(known.begin(), known.end());
  if (*high >= 1.02 * *low) return 0.0;
  const Eigen::Vector3d plane = rows.colPivHouseholderQr().solve(right);
  return 1.0 / plane.dot(Eigen::Vector3d(1.0, x, y));
}

std::optional<Candidate> CandidateAt(const FrameView& view, int index, int u,
                                     int v, const DirectOptions& options) {
  const FrameView::Level& level = view.levels[index];
  const int du = level.gray.At(u + 1, v) - level.gray.At(u - 1, v);
  const int dv = level.gray.At(u, v + 1) - level.gray.At(u, v - 1);
  const int square = du * du + dv * dv;
  if (std::sqrt(square) / 2.0 <= options.min_gradient) return std::nullopt;
  Candidate candidate;
  candidate.square = square;
  // The pixels of level 1 are between four of level 0.
  const double z = index == 0 ? DepthOfPlane(view, u, v, u, v)
                              : DepthOfPlane(view, 2 * u + 1, 2 * v + 1,
                                             2 * u + 0.5, 2 * v + 0.5);
  // A cell whose steepest pixel has no valid depth has no point.
  if (z < options.min_depth || z > options.max_depth) return candidate;
  const Camera& camera = level.camera;
  candidate.point.resize(5);
  candidate.point << (u - camera.cx) / camera.fx * z,
      (v - camera.cy) / camera.fy * z, z, 0.002 * z * z, level.gray.At(u, v);
  return candidate;
}

class TexturedPointsTest : public ::testing::TestWithParam<int> {};

TEST_P(TexturedPointsTest, AreTheSteepestPixelsOfTheirCells) {
  const int level = GetParam();
  PaintedFrame frame(96, 80);
  PaintAtRandom(&frame);
  DirectOptions options;
  options.max_points = level == 0 ? 96 * 80 / 36 : 48 * 40 / 36;
  options.min_gradient = 7.0;
  options.min_depth = 1.2;
  options.max_depth = 1.4;
  constexpr int kCell = 6;
  // The neighbourhood of a point stays within the image at any level.
  const int border = level == 0 ? 7 : 4;
  const ImageView<uint8_t>& gray = frame.view.levels[level].gray;
  std::vector<Eigen::VectorXd> expected;
  int flat = 0, without_depth = 0;
  for (int top = border; top < gray.height - border; top += kCell) {
    for (int left = border; left < gray.width - border; left += kCell) {
      Candidate best;
      for (int k = 0; k < kCell * kCell; ++k) {
        const int u = left + k % kCell, v = top + k / kCell;
        if (u >= gray.width - border || v >= gray.height - border) continue;
        const auto found = CandidateAt(frame.view, level, u, v, options);
        if (found.has_value() && found->square > best.square) best = *found;
      }
      flat += best.square == 0;
      without_depth += best.square > 0 && best.point.size() == 0;
      if (best.point.size() > 0) expected.push_back(best.point);
    }
  }
  EXPECT_GT(flat, 3);
  EXPECT_GT(without_depth, 3);
  EXPECT_GT(expected.size(), 12u);

  PackedColumns points;
  TexturedPoints(frame.view, level, options, &points);
  const std::vector<Eigen::VectorXd> actual = Rows(points, 5);
  ASSERT_EQ(actual.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LE((actual[i] - expected[i]).norm(), 1e-9)
        << actual[i].transpose() << "\n"
        << expected[i].transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, TexturedPointsTest, ::testing::Values(0, 1));

// Size of an image with a single cell, with one point in the middle.
constexpr int kSide = 64;
constexpr int kMiddle = 7 + kSide / 2;

std::vector<Eigen::VectorXd> SmoothPointsOf(const PaintedFrame& frame,
                                            double max_depth = 8.0) {
  PackedColumns points;
  DirectOptions options;
  options.max_points = 1;
  options.max_depth = max_depth;
  SmoothPoints(frame.view, /*level=*/0, options, &points);
  return Rows(points, 7);
}

TEST(SmoothPointsTest, LieOnThePlaneAround) {
  PaintedFrame frame(kSide, kSide);
  const double a = 0.5, b = 0.003, c = -0.002;
  frame.PaintPlane(a, b, c);
  const std::vector<Eigen::VectorXd> points = SmoothPointsOf(frame);
  ASSERT_EQ(points.size(), 1u);
  const Camera& camera = frame.view.levels[0].camera;
  const double z = 1.0 / (a + (b + c) * kMiddle);
  const Eigen::Vector3d X((kMiddle - camera.cx) / camera.fx * z,
                          (kMiddle - camera.cy) / camera.fy * z, z);
  // 1 / z = N . ray, and u = fx x + cx.
  const Eigen::Vector3d N(b * camera.fx, c * camera.fy,
                          a + b * camera.cx + c * camera.cy);
  // Depths are rounded to whole units.
  EXPECT_LE((points[0].head<3>() - X).norm(), 1e-4);
  EXPECT_LE((points[0].segment<3>(3) - N).norm(), 5e-4);
  EXPECT_NEAR(points[0][6], 0.002 * z * z, 1e-6);
  EXPECT_TRUE(SmoothPointsOf(frame, 0.99 * z).empty());
}

// The number of points on a plane 1 m away. `degrees` is the angle between the
// plane and the ray to its middle; the ray is 50 degrees off the axis.
size_t CountOfSlanted(double degrees) {
  PaintedFrame frame(kSide, kSide);
  Camera& camera = frame.view.levels[0].camera;
  camera.cx = -30.0;
  const Eigen::Vector3d ray((kMiddle - camera.cx) / camera.fx,
                            (kMiddle - camera.cy) / camera.fy, 1.0);
  const double angle = degrees * M_PI / 180.0;
  const Eigen::Vector3d r = ray.normalized();
  const Eigen::Vector3d side = r.cross(Eigen::Vector3d::UnitX()).normalized();
  const Eigen::Vector3d n = std::sin(angle) * r + std::cos(angle) * side;
  const Eigen::Vector3d N = n / n.dot(ray);
  const double b = N.x() / camera.fx, c = N.y() / camera.fy;
  frame.PaintPlane(N.z() - b * camera.cx - c * camera.cy, b, c);
  return SmoothPointsOf(frame).size();
}

TEST(SmoothPointsTest, OfASurfaceSeenFromItsSideThereIsNone) {
  EXPECT_EQ(CountOfSlanted(90.0), 1u);
  EXPECT_EQ(CountOfSlanted(16.0), 1u);
  EXPECT_EQ(CountOfSlanted(13.0), 0u);
}

// The points of a wall at `z` with one of 25 depths moved by `sigmas`.
size_t CountWithOneOff(double sigmas, double z) {
  PaintedFrame frame(kSide, kSide);
  frame.PaintPlane(1.0 / z, 0.0, 0.0);
  frame.SetDepth(kMiddle + 3, kMiddle - 6, z + sigmas * 0.002 * z * z);
  return SmoothPointsOf(frame).size();
}

TEST(SmoothPointsTest, OfAnEdgeThereIsNone) {
  for (const double z : {0.5, 1.5, 3.0}) {
    EXPECT_EQ(CountWithOneOff(0.0, z), 1u) << z;
    // The fitted plane partly follows the moved depth.
    EXPECT_EQ(CountWithOneOff(4.2, z), 1u) << z;
    EXPECT_EQ(CountWithOneOff(5.2, z), 0u) << z;
    EXPECT_EQ(CountWithOneOff(-5.2, z), 0u) << z;
  }
}

TEST(SmoothPointsTest, BesideAHoleThereIsNone) {
  PaintedFrame frame(kSide, kSide);
  frame.PaintPlane(0.5, 0.003, -0.002);
  frame.SetDepth(kMiddle + 1, kMiddle, 0.0);
  EXPECT_EQ(SmoothPointsOf(frame).size(), 1u) << "between the pixels used";
  frame.SetDepth(kMiddle + 3, kMiddle, 0.0);
  EXPECT_TRUE(SmoothPointsOf(frame).empty());
}

}  // namespace
}  // namespace rgbd_pose
