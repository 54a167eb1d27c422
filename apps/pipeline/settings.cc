#include "apps/pipeline/settings.h"

namespace rgbd_pose {

Estimator MakeEstimator(const EstimatorSettings& settings) {
  return Estimator(settings.options,
                   MakeRobustCosts(settings.cost, settings.loss));
}

Estimator MakeDirectEstimator(const DirectSettings& settings) {
  return Estimator(
      settings.options,
      MakeDirectCosts(settings.cost, settings.loss, settings.points));
}

std::unique_ptr<Tracker> MakeTracker(const OdometrySettings& settings,
                                     const Camera& camera) {
  FrontendOptions features = settings.features;
  features.camera = camera;
  DirectSettings direct = settings.direct;
  direct.points.min_depth = features.min_depth;
  direct.points.max_depth = features.max_depth;
  return MakeTracker(
      settings.tracker,
      {settings.tracking, features, settings.frontend,
       MakeEstimator(settings.estimator), MakeDirectEstimator(direct),
       MakeCoarseEstimator(direct.points), settings.direct_tracking});
}

Odometry MakeOdometry(const OdometrySettings& settings, const Camera& camera) {
  return Odometry(settings.odometry, MakeTracker(settings, camera));
}

}  // namespace rgbd_pose
