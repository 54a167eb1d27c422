#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/util/parallel_for.h"
#include "core/util/quantile.h"
#include "costs/calibration/landmark_model.h"
#include "frontend/calibration/calibration_data.h"
#include "frontend/frame/depth_warper.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// How far the depth image is displaced at the row of a measurement.
struct Displacement {
  Eigen::Vector3d rotation;     // rad
  Eigen::Vector3d translation;  // m

  Displacement(const CalibrationVector& theta, const RowMotion& motion) {
    const double lag = DepthLag(theta.data(), motion.row);
    rotation = theta.segment<3>(kRotationX) - lag * motion.twist.angular;
    translation = theta.segment<3>(kTranslationX) - lag * motion.twist.linear;
  }
};

// The plane is fitted to 7 x 7 pixels. This many of them must be on it.
constexpr int kReach = 3;
constexpr int kNumPixels = (2 * kReach + 1) * (2 * kReach + 1);
constexpr int kMinOnPlane = 44;

// Returns the surface around an image point (px, distorted) as a plane m . X =
// z, where X is a point on the plane and z is the depth at the image point.
// Thus m . r = 1 for the ray r = (a, b, 1) of the image point. Returns zero if
// there is no plane. It is fitted to inverse depths of pixels that are up to 6
// px away in a VGA image; with nearer or fewer, its slope is mostly noise.
Eigen::Vector3d LookUpPlane(const Frame& frame, const Camera& camera,
                            const Eigen::Vector2d& pixel,
                            const DepthNoiseModel& noise) {
  const int column = static_cast<int>(std::lround(pixel.x()));
  const int row = static_cast<int>(std::lround(pixel.y()));
  // The spacing corresponds to 2 px of a VGA image.
  const int stride = std::max(1, frame.depth.cols / 320);
  const int border = kReach * stride;
  if (!camera.Contains({column, row}, border)) return Eigen::Vector3d::Zero();
  Eigen::Vector3d at[kNumPixels];  // column and row in the grid, 1
  double inverse[kNumPixels];
  int count = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int i = -kReach; i <= kReach; ++i) {
    for (int j = -kReach; j <= kReach; ++j) {
      const double depth = frame.DepthAt(column + j * stride, row + i * stride);
      if (depth == 0.0) continue;
      at[count] << j, i, 1.0;
      inverse[count] = 1.0 / depth;
      normal += at[count] * at[count].transpose();
      right += at[count] * inverse[count];
      ++count;
    }
  }
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  const double middle = fit[2];
  if (!(middle > 0.0)) return Eigen::Vector3d::Zero();
  // A pixel is on the plane up to this many sigmas, or up to this share of the
  // depth, which tolerates a curved surface; d(1/z) = dz / z^2.
  constexpr double kMaxSigmas = 3.0;
  constexpr double kMaxBulge = 0.01;
  const double limit =
      std::max(kMaxSigmas * noise.sigma(1.0 / middle) * middle * middle,
               kMaxBulge * middle);
  int on_plane = count;
  for (int k = 0; k < count; ++k) {
    if (std::abs(inverse[k] - fit.dot(at[k])) > limit) --on_plane;
  }
  if (on_plane < kMinOnPlane) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d ray = camera.Unproject(pixel, 1.0);
  Eigen::Vector3d plane;
  plane.head<2>() = camera.ProjectDerivative(ray.head<2>()).transpose() *
                    fit.head<2>() / (stride * middle);
  plane.z() = 1.0 - plane.x() * ray.x() - plane.y() * ray.y();
  return plane;
}

}  // namespace

bool IsDisplaced(const CalibrationVector& theta) {
  constexpr double kRotation = 5e-4;     // rad
  constexpr double kTranslation = 1e-3;  // m
  constexpr double kDelay = 5e-4;        // s
  return theta.segment<3>(kRotationX).norm() > kRotation ||
         theta.segment<3>(kTranslationX).norm() > kTranslation ||
         std::abs(theta[kDepthTime]) +
                 0.5 * std::abs(theta[kDepthReadout] - theta[kColorReadout]) >
             kDelay;
}

double DisplacementPx(const CalibrationViews& views,
                      const CalibrationVector& change) {
  // Colour is displaced most in its first row.
  CalibrationVector of_color = CalibrationVector::Zero();
  of_color[kDepthTime] = 0.5 * change[kColorReadout];
  std::vector<double> all;
  for (const Landmark& landmark : views.landmarks) {
    const auto flow = [&](const CalibrationVector& theta) {
      const Displacement displaced(
          theta, MotionAt(views, landmark.anchor, landmark.v));
      const Eigen::Vector3d& ray = landmark.depth.ray;
      const Eigen::Vector3d moved =
          displaced.rotation.cross(ray) +
          landmark.depth.value * displaced.translation;
      return views.camera.fx * (moved - moved.z() * ray).head<2>().norm();
    };
    all.push_back(std::max(flow(change), flow(of_color)));
  }
  return all.empty() ? 0.0 : Median(all);
}

void LookUpDepthsAgain(const KeyframeMap& map, const Camera& camera,
                       const DepthLookupOptions& options,
                       const CalibrationVector& theta, int threads,
                       CalibrationData* data) {
  const int num_keyframes = static_cast<int>(data->in_map.size());
  // By keyframe: its own landmarks, and its views of other landmarks.
  std::vector<std::vector<DepthPixel*>> pixels(num_keyframes);
  for (Landmark& landmark : data->views.landmarks) {
    pixels[landmark.anchor].push_back(&landmark);
  }
  for (LandmarkView& view : data->views.views) {
    pixels[view.keyframe].push_back(&view);
  }
  ParallelFor(num_keyframes, threads, [&](int k) {
    if (pixels[k].empty()) return;
    const auto displacement_at = [&](double row) {
      return Displacement(theta, MotionAt(data->views, k, row));
    };
    const auto undo = [&](double row) {
      const Displacement moved = displacement_at(row);
      return Rigid3d::FromRotationVector(moved.rotation, moved.translation)
          .Inverse();
    };
    Frame frame = map.keyframes[data->in_map[k]].images.Restore();
    frame.depth = DepthWarper(camera).Move(frame, undo).clone();
    for (DepthPixel* pixel : pixels[k]) {
      const Displacement undone = displacement_at(pixel->v);
      const Observation o =
          Observe(frame, camera, pixel->u, pixel->v, 1.0, options);
      MeasuredInverseDepth updated =
          MeasuredAt(frame, camera, o, {pixel->u, pixel->v}, options.noise);
      updated.undone_rotation = undone.rotation;
      updated.undone_translation = undone.translation;
      // Without a valid depth, a landmark keeps its value as initial guess.
      if (updated.inverse_sigma == 0.0) updated.value = pixel->depth.value;
      pixel->depth = updated;
    }
  });
}

MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const DepthNoiseModel& noise) {
  MeasuredInverseDepth depth;
  if (o.depth <= 0.0) return depth;
  depth.value = 1.0 / o.depth;
  depth.plane = LookUpPlane(frame, camera, pixel, noise);
  if (depth.plane.isZero(0.0)) return depth;
  depth.ray = camera.Ray(o.u, o.v);
  depth.inverse_sigma = o.depth * o.depth / o.sigma_depth;
  const Eigen::Vector2d middle(std::round(pixel.x()), std::round(pixel.y()));
  const double at_middle =
      frame.DepthAt(static_cast<int>(middle.x()), static_cast<int>(middle.y()));
  if (at_middle > 0.0) {
    depth.pixel_value = 1.0 / at_middle;
    depth.pixel_ray = camera.Unproject(middle, 1.0);
  }
  return depth;
}

}  // namespace rgbd_pose
