#include "apps/calibration/displaced_depths.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "apps/calibration/measured_depth.h"
#include "core/util/parallel_for.h"
#include "core/util/quantile.h"
#include "frontend/frame/depth_warper.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// How far (rad and m, not per second) depth is off in an image that was taken
// at this velocity.
CameraVelocity DisplacementOf(const CalibrationVector& theta,
                              const CameraVelocity& velocity) {
  const double delay = theta[kDepthTime];
  return {theta.segment<3>(kRotationX) + delay * velocity.rotation,
          theta.segment<3>(kTranslationX) + delay * velocity.translation};
}

// Looks a depth up in an image in which a displacement has been undone.
void LookUpAnew(const Frame& frame, const Camera& camera,
                const DepthLookupOptions& options, double u, double v,
                const CameraVelocity& undone, MeasuredInverseDepth* depth) {
  const Observation o = Observe(frame, camera, u, v, 1.0, options);
  const CameraVelocity velocity{depth->rate_rotation, depth->rate_translation};
  MeasuredInverseDepth updated =
      MeasuredAt(frame, camera, o, {u, v}, velocity, options.noise);
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
         std::abs(theta[kDepthTime]) > kDelay;
}

double DisplacementPx(const CalibrationViews& views,
                      const CalibrationVector& change) {
  std::vector<double> all;
  for (const Landmark& landmark : views.landmarks) {
    const MeasuredInverseDepth& at = landmark.depth;
    const Eigen::Vector3d turn =
        change.segment<3>(kRotationX) + change[kDepthTime] * at.rate_rotation;
    const Eigen::Vector3d shift = change.segment<3>(kTranslationX) +
                                  change[kDepthTime] * at.rate_translation;
    const Eigen::Vector3d moved = turn.cross(at.ray) + at.value * shift;
    all.push_back(views.camera.fx *
                  (moved - moved.z() * at.ray).head<2>().norm());
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
    const CameraVelocity moved = DisplacementOf(theta, data->velocities[k]);
    const Rigid3d measured_from_moved =
        Rigid3d::FromRotationVector(moved.rotation, moved.translation);
    Frame frame = map.keyframes[data->in_map[k]].images.Restore();
    frame.depth =
        DepthWarper(camera).Move(frame, measured_from_moved.Inverse()).clone();
    for (Landmark* landmark : landmarks[k]) {
      LookUpAnew(frame, camera, options, landmark->u, landmark->v, moved,
                 &landmark->depth);
    }
    for (LandmarkView* view : views[k]) {
      LookUpAnew(frame, camera, options, view->u, view->v, moved, &view->depth);
    }
  });
}

}  // namespace rgbd_pose
