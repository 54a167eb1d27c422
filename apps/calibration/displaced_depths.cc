#include "apps/calibration/displaced_depths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/util/parallel_for.h"
#include "core/util/quantile.h"
#include "frontend/frame/depth_warper.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// How far depth is off where it was measured.
struct Displacement {
  Eigen::Vector3d rotation;     // rad
  Eigen::Vector3d translation;  // m

  Displacement(const CalibrationVector& theta, const RowMotion& motion) {
    const double lag = DepthLag(theta.data(), motion.row);
    rotation = theta.segment<3>(kRotationX) - lag * motion.twist.angular;
    translation = theta.segment<3>(kTranslationX) - lag * motion.twist.linear;
  }

  // How far (px, about) it moves what is seen along a ray at an inverse depth.
  double Flow(double fx, const Eigen::Vector3d& ray, double inverse) const {
    const Eigen::Vector3d moved = rotation.cross(ray) + inverse * translation;
    return fx * (moved - moved.z() * ray).head<2>().norm();
  }
};

// Looks a depth up in an image in which a displacement has been undone.
void LookUpAnew(const Frame& frame, const Camera& camera,
                const DepthLookupOptions& options, double u, double v,
                const Displacement& undone, MeasuredInverseDepth* depth) {
  const Observation o = Observe(frame, camera, u, v, 1.0, options);
  MeasuredInverseDepth updated =
      MeasuredAt(frame, camera, o, {u, v}, options.noise);
  updated.undone_rotation = undone.rotation;
  updated.undone_translation = undone.translation;
  // A landmark keeps a value to begin with.
  if (updated.inverse_sigma == 0.0) updated.value = depth->value;
  *depth = updated;
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
  std::vector<double> all;
  for (const Landmark& landmark : views.landmarks) {
    const MeasuredInverseDepth& at = landmark.depth;
    const RowMotion motion = MotionAt(views, landmark.anchor, landmark.v);
    const double depth =
        Displacement(change, motion).Flow(views.camera.fx, at.ray, at.value);
    // The first row of colour.
    CalibrationVector readout = CalibrationVector::Zero();
    readout[kDepthTime] = 0.5 * change[kColorReadout];
    const double color =
        Displacement(readout, motion).Flow(views.camera.fx, at.ray, at.value);
    all.push_back(std::max(depth, color));
  }
  return all.empty() ? 0.0 : Median(all);
}

void LookUpDepthsAnew(const KeyframeMap& map, const Camera& camera,
                      const OdometrySettings& settings,
                      const CalibrationVector& theta, int threads,
                      CalibrationData* data) {
  FrontendOptions features = settings.features;
  features.camera = camera;
  const DepthLookupOptions options = features.DepthLookup();
  const int num_keyframes = static_cast<int>(data->in_map.size());
  // By keyframe: its own landmarks, and what it sees of others.
  std::vector<std::vector<Landmark*>> landmarks(num_keyframes);
  std::vector<std::vector<LandmarkView*>> views(num_keyframes);
  for (Landmark& landmark : data->views.landmarks) {
    landmarks[landmark.anchor].push_back(&landmark);
  }
  for (LandmarkView& view : data->views.views) {
    views[view.keyframe].push_back(&view);
  }
  ParallelFor(num_keyframes, threads, [&](int k) {
    if (landmarks[k].empty() && views[k].empty()) return;
    const auto moved_at = [&](double row) {
      return Displacement(theta, MotionAt(data->views, k, row));
    };
    Frame frame = map.keyframes[data->in_map[k]].images.Restore();
    frame.depth = DepthWarper(camera)
                      .Move(frame,
                            [&](double row) {
                              const Displacement moved = moved_at(row);
                              return Rigid3d::FromRotationVector(
                                         moved.rotation, moved.translation)
                                  .Inverse();
                            })
                      .clone();
    for (Landmark* landmark : landmarks[k]) {
      LookUpAnew(frame, camera, options, landmark->u, landmark->v,
                 moved_at(landmark->v), &landmark->depth);
    }
    for (LandmarkView* view : views[k]) {
      LookUpAnew(frame, camera, options, view->u, view->v, moved_at(view->v),
                 &view->depth);
    }
  });
}

}  // namespace rgbd_pose
