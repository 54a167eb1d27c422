#include "apps/pipeline/settings.h"

namespace rgbd_pose {

Estimator MakeEstimator(const EstimatorSettings& settings) {
  return Estimator(settings.options,
                   MakeRobustCosts(settings.cost, settings.loss));
}

Odometry MakeOdometry(const OdometrySettings& settings, const Camera& camera) {
  FrontendOptions features = settings.features;
  features.camera = camera;
  return Odometry(settings.odometry,
                  MakeTracker(settings.tracker,
                              {settings.tracking, features, settings.frontend,
                               MakeEstimator(settings.estimator)}));
}

}  // namespace rgbd_pose
