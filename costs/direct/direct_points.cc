#include "costs/direct/direct_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/estimation/inverse_depth_plane.h"
#include "costs/direct/surface.h"

namespace rgbd_pose {
namespace {

// Image border without points, px: neighbours of a point reach that far.
constexpr int kBorder = 7;

int CellSize(double pixels, int max_points) {
  return std::max(1, static_cast<int>(std::sqrt(pixels / max_points)));
}

// Distance between the depths that a slope is computed from, px.
constexpr int kSlopeStep = 3;

// The plane through the 3 x 3 depths around a pixel of the full resolution.
// Nothing if more than two are missing, or if they do not belong to one surface
// with a slope of up to about 75 degrees.
std::optional<InverseDepthPlane> PlaneAround(const FrameView& frame, int column,
                                             int row) {
  constexpr double kMaxRelativeStep = 0.02;
  // A whole side is missing where one object hides another, and what is steep
  // there is the silhouette.
  constexpr int kMinDepths = 7;
  InverseDepthGrid<3> grid;
  double low = INFINITY, high = 0.0;
  for (int v = -1; v <= 1; ++v) {
    for (int u = -1; u <= 1; ++u) {
      const double z = frame.DepthAt(column + u, row + v);
      if (z == 0.0) continue;
      low = std::min(low, z);
      high = std::max(high, z);
      grid.Add(u, v, 1.0 / z);
    }
  }
  if (!(high - low < kMaxRelativeStep * low)) return std::nullopt;
  return grid.Fit(kMinDepths);
}

// Finds the point (camera axes at the stamp, m) that a pixel of a level shows
// if rows, or gray levels and depths, were exposed at different times. (column,
// row): as in DepthBefore. The depth was measured when the camera saw the point
// elsewhere; where that is depends on the depth itself, so it is looked up
// again if it was far from what was expected.
bool MovingPoint(const FrameView& frame, const FrameView::Level& level,
                 const Eigen::Vector2i& at, int column, int row, double* depth,
                 Eigen::Vector3d* X) {
  constexpr double kUsualDepth = 2.0;    // m, to begin with where none is known
  constexpr double kSmallChange = 0.01;  // relative depth: a tenth of a pixel
  constexpr int kSteps = 2;
  const FrameTiming& timing = frame.timing;
  const Camera& camera = frame.levels[0].camera;
  const Lens<double> lens = camera.MakeLens();
  const Eigen::Vector3d ray = level.camera.Unproject(at.cast<double>(), 1.0);
  if (!ray.allFinite()) return false;
  const double seconds = timing.color.RowTime(at.y(), level.gray.height);
  double z = frame.DepthAt(column, row);
  if (z == 0.0) z = kUsualDepth;
  for (int step = 0; step < kSteps; ++step) {
    *X = timing.twist.MovedBack(ray * z, seconds);
    Eigen::Vector3d measured;
    MoveToRow(camera, lens, timing.depth, timing.twist, X->data(),
              measured.data());
    if (!(measured.z() > DirectInput::kMinDepth)) return false;
    const Eigen::Vector2d pixel = camera.Project(measured);
    if (!(pixel.x() >= 1.5 && pixel.y() >= 1.5 &&
          pixel.x() < frame.depth.width - 2.5 &&
          pixel.y() < frame.depth.height - 2.5)) {
      return false;
    }
    const int u = static_cast<int>(pixel.x() + 0.5);
    const int v = static_cast<int>(pixel.y() + 0.5);
    const std::optional<InverseDepthPlane> plane = PlaneAround(frame, u, v);
    if (!plane.has_value()) return false;
    const double seen = 1.0 / plane->At(pixel.x() - u, pixel.y() - v);
    const double change = seen - measured.z();
    z += change;
    if (std::abs(change) < kSmallChange * z) break;
  }
  *depth = z;
  *X = timing.twist.MovedBack(ray * z, seconds);
  return true;
}

// The plane through 5 x 5 depths around a pixel of the full resolution, which
// are kSlopeStep apart. Nothing where the depths form no plane, as at an edge,
// and at any hole: so wide a window beside a Kinect's hole is mostly at an
// edge.
std::optional<InverseDepthPlane> WidePlaneAround(const FrameView& frame,
                                                 int column, int row) {
  // Neighbours farther from the plane belong to another surface.
  constexpr double kMaxSigmas = 4.0;
  constexpr int kSide = 5, kHalf = kSide / 2;
  double inverse[kSide * kSide];
  InverseDepthGrid<kSide> grid;
  for (int k = 0; k < kSide * kSide; ++k) {
    const int i = k % kSide - kHalf, j = k / kSide - kHalf;
    const double z =
        frame.DepthAt(column + i * kSlopeStep, row + j * kSlopeStep);
    if (z == 0.0) return std::nullopt;
    inverse[k] = 1.0 / z;
    grid.Add(i, j, inverse[k]);
  }
  const InverseDepthPlane plane = *grid.Fit(kSide * kSide);
  const double depth = 1.0 / plane.middle;
  const double limit =
      kMaxSigmas * frame.depth_noise.sigma(depth) * plane.middle * plane.middle;
  for (int k = 0; k < kSide * kSide; ++k) {
    const int i = k % kSide - kHalf, j = k / kSide - kHalf;
    if (!(std::abs(inverse[k] - plane.At(i, j)) <= limit)) return std::nullopt;
  }
  return plane;
}

// The pixel of a cell with the largest gradient; (-1, -1) if no pixel exceeds
// the limit (squared difference of the gray levels of opposite neighbours).
Eigen::Vector2i SteepestPixel(const ImageView<uint8_t>& gray, int left, int top,
                              int right, int bottom, int limit) {
  Eigen::Vector2i steepest(-1, -1);
  for (int v = top; v < bottom; ++v) {
    const uint8_t* const row = gray.data + v * gray.stride;
    for (int u = left; u < right; ++u) {
      const int du = row[u + 1] - row[u - 1];
      const int dv = row[u + gray.stride] - row[u - gray.stride];
      const int square = du * du + dv * dv;
      if (square <= limit) continue;
      limit = square;
      steepest = {u, v};
    }
  }
  return steepest;
}

}  // namespace

void TexturedPoints(const FrameView& frame, int level_index,
                    const DirectOptions& options, PackedColumns* points) {
  const FrameView::Level& level = frame.levels[level_index];
  const ImageView<uint8_t>& gray = level.gray;
  const int cell = CellSize(static_cast<double>(gray.width) * gray.height,
                            options.max_points);
  const int scale = 1 << level_index;
  const double to_centre = scale == 1 ? 0.0 : -0.5;  // px
  const int border = std::max(2, (kBorder + scale - 1) / scale);
  const int flat =
      static_cast<int>(4.0 * options.min_gradient * options.min_gradient);
  const bool moves = !frame.timing.IsOneMoment();
  points->Clear(
      5, static_cast<size_t>(gray.width / cell + 1) * (gray.height / cell + 1));
  for (int top = border; top < gray.height - border; top += cell) {
    const int bottom = std::min(top + cell, gray.height - border);
    for (int left = border; left < gray.width - border; left += cell) {
      const int right = std::min(left + cell, gray.width - border);
      const Eigen::Vector2i at =
          SteepestPixel(gray, left, top, right, bottom, flat);
      if (at.x() < 0) continue;
      // The full-resolution pixel at its centre, or to the lower right of it.
      const int u = at.x() * scale + scale / 2;
      const int v = at.y() * scale + scale / 2;
      double depth = 0.0;
      Eigen::Vector3d X;
      if (moves) {
        if (!MovingPoint(frame, level, at, u, v, &depth, &X)) continue;
        X = frame.reference_from_stamp * X;
      } else {
        const std::optional<InverseDepthPlane> plane = PlaneAround(frame, u, v);
        if (!plane.has_value()) continue;
        depth = 1.0 / plane->At(to_centre, to_centre);
        X = level.camera.Unproject(at.cast<double>(), depth);
        if (!X.allFinite()) continue;
      }
      if (depth < options.min_depth || depth > options.max_depth) continue;
      points->Append(std::array{X.x(), X.y(), X.z(),
                                frame.depth_noise.sigma(depth),
                                static_cast<double>(gray.At(at.x(), at.y()))});
    }
  }
  points->Pad();
}

void SmoothPoints(const FrameView& frame, int /*level*/,
                  const DirectOptions& options, PackedColumns* points) {
  // At angles between ray and surface below 15 degrees, points hardly help.
  constexpr double kMinCosine = 0.25;
  const Camera& camera = frame.levels[0].camera;
  const FrameTiming& timing = frame.timing;
  const bool moves = !timing.IsOneMoment();
  const int width = frame.depth.width, height = frame.depth.height;
  const double per_row = timing.depth.readout / height;  // s
  const int cell =
      CellSize(static_cast<double>(width) * height, options.max_points);
  points->Clear(7, static_cast<size_t>(width / cell + 1) * (height / cell + 1));
  for (int v = kBorder + cell / 2; v < height - kBorder; v += cell) {
    const double taken_at = timing.depth.RowTime(v, height);
    Rigid3d moved;  // from where the camera was when it measured this row
    if (moves) {
      moved = frame.reference_from_stamp * timing.twist.MotionBack(taken_at);
    }
    for (int u = kBorder + cell / 2; u < width - kBorder; u += cell) {
      const std::optional<InverseDepthPlane> fit = WidePlaneAround(frame, u, v);
      if (!fit.has_value()) continue;
      const double inverse_depth = fit->middle;
      const double depth = 1.0 / inverse_depth;
      if (depth < options.min_depth || depth > options.max_depth) continue;
      Eigen::Vector3d X = camera.Unproject(Eigen::Vector2d(u, v), depth);
      const Eigen::Vector3d ray = X / depth;
      Eigen::Matrix2d pixels = camera.ProjectDerivative(ray.head<2>());
      Eigen::Vector2d by_pixel = fit->slope / kSlopeStep;
      if (moves) {
        // The next row is measured later, from where the camera is then.
        Eigen::Vector3d velocity;
        timing.twist.After(taken_at).PointVelocity(X.data(), velocity.data());
        const double shift = per_row * inverse_depth;
        Eigen::Matrix2d rays = pixels.inverse();
        rays.col(1) -=
            shift * (velocity.head<2>() - velocity.z() * ray.head<2>());
        by_pixel.y() += shift * inverse_depth * velocity.z();
        pixels = rays.inverse();
      }
      const Eigen::Vector2d slope = pixels.transpose() * by_pixel;
      Eigen::Vector3d N(slope.x(), slope.y(),
                        inverse_depth - slope.dot(ray.head<2>()));
      if (!(N.dot(ray) > kMinCosine * N.norm() * ray.norm())) continue;
      if (moves) {
        X = moved * X;
        N = moved.rotation * N;
        N /= N.dot(X);
      }
      points->Append(std::array{X.x(), X.y(), X.z(), N.x(), N.y(), N.z(),
                                frame.depth_noise.sigma(depth)});
    }
  }
  points->Pad();
}

}  // namespace rgbd_pose
