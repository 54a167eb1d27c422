#include "apps/pipeline/settings.h"

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

void Require(const std::string& problem) {
  if (!problem.empty()) throw InputError(problem);
}

}  // namespace

Estimator MakeEstimator(const EstimatorSettings& settings) {
  Require(settings.options.Check());
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
