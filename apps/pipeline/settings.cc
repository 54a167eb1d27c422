#include "apps/pipeline/settings.h"

namespace rgbd_pose {

Estimator MakeEstimator(const EstimatorSettings& settings) {
  return Estimator(settings.options,
                   MakeRobustCosts(settings.cost, settings.loss));
}

DirectEstimators MakeDirectEstimators(const EstimatorSettings& matches,
                                      const DirectSettings& pixels) {
  return {Estimator(pixels.options,
                    MakeDirectCosts(pixels.cost, kLeadingLoss, pixels.points)),
          Estimator(pixels.options,
                    JoinCosts(MakeRobustCosts(matches.cost, matches.loss),
                              MakeDirectCosts(pixels.cost, pixels.loss,
                                              pixels.points))),
          MakeCoarseEstimator(pixels.points)};
}

std::unique_ptr<Tracker> MakeTracker(const OdometrySettings& settings,
                                     const Camera& camera) {
  FrontendOptions features = settings.features;
  features.camera = camera;
  DirectSettings direct = settings.direct;
  direct.points.min_depth = features.min_depth;
  direct.points.max_depth = features.max_depth;
  return MakeTracker(settings.tracker,
                     {settings.tracking, features, settings.frontend,
                      MakeEstimator(settings.estimator),
                      MakeDirectEstimators(settings.estimator, direct),
                      settings.direct_tracking});
}

Odometry MakeOdometry(const OdometrySettings& settings, const Camera& camera) {
  return Odometry(settings.odometry, MakeTracker(settings, camera));
}

}  // namespace rgbd_pose
