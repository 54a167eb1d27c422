#include "frontend/settings/settings.h"

#include <algorithm>
#include <iterator>

#include "core/initial_guess/initial_guess.h"
#include "core/util/named_values.h"
#include "frontend/files/depth_noise_file.h"
#include "robust/m_estimator.h"
#include "robust/scale.h"

namespace rgbd_pose {
namespace {

constexpr char kFeatures[] = "Features";
constexpr char kTracking[] = "Tracking";

constexpr Named<Assembly> kAssemblies[] = {
    {"compressed", Assembly::kCompressed},
    {"per_match", Assembly::kPerMatch},
    {"autodiff", Assembly::kAutodiff},
};

constexpr Named<RobustSchedule> kRobustSchedules[] = {
    {"gnc", RobustSchedule::kGnc},
    {"direct", RobustSchedule::kDirect},
};

constexpr Named<LostPolicy> kLostPolicies[] = {
    {"stop", LostPolicy::kStop},
    {"hold", LostPolicy::kHold},
    {"predict", LostPolicy::kPredict},
    {"new_segment", LostPolicy::kNewSegment},
};

constexpr Named<ShutterUse> kShutterUses[] = {
    {"camera", ShutterUse::kCamera},
    {"none", ShutterUse::kNone},
};

template <typename Value, size_t N>
NamedSetting ByName(const Named<Value> (&rows)[N], const char* what,
                    Value* value) {
  const auto is_set = [value](const Named<Value>& row) {
    return row.value == *value;
  };
  return {[&rows, is_set]() -> std::string {
            return std::find_if(std::begin(rows), std::end(rows), is_set)->name;
          },
          [&rows, what, value](const std::string& name) {
            *value = RowOf(rows, what, name).value;
          }};
}

NamedSetting ScaleByName(decltype(EstimatorOptions::scale)* scale) {
  return {[=] {
            for (const ScaleEstimator& row : ScaleEstimators()) {
              if (row.estimate == *scale) return std::string(row.name);
            }
            return std::string("a custom function");
          },
          [=](const std::string& name) {
            *scale = RowOf(ScaleEstimators(), "scale", name).estimate;
          }};
}

// The last pose, or a row of InitialGuesses().
std::vector<std::string> GuessNames() {
  std::vector<std::string> names = {"last"};
  for (const InitialGuess& row : InitialGuesses()) names.emplace_back(row.name);
  return names;
}

NamedSetting GuessByName(TrackerOptions* tracking) {
  return {[=]() -> std::string {
            return tracking->initial_guess != nullptr
                       ? std::string(tracking->initial_guess->name)
                       : "last";
          },
          [=](const std::string& name) {
            tracking->initial_guess = FindNamed(InitialGuesses(), name);
            if (tracking->initial_guess == nullptr && name != "last") {
              throw UnknownName("initial guess", name, GuessNames());
            }
          }};
}

// The name for no model: that of the camera.
constexpr char kOfCamera[] = "camera";

std::vector<std::string> DepthNoiseNames() {
  std::vector<std::string> names = NamesOf(DepthNoiseModels());
  names.insert(names.begin(), kOfCamera);
  return names;
}

NamedSetting DepthNoiseByName(std::optional<DepthNoiseModel>* model) {
  return {[=] { return model->has_value() ? (*model)->name : kOfCamera; },
          [=](const std::string& name) {
            model->reset();
            if (name != kOfCamera) *model = ResolveDepthNoise(name);
          }};
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

}  // namespace

Estimator MakeEstimator(const EstimatorSettings& settings) {
  return Estimator(settings.options,
                   MakeRobustCosts(settings.cost, settings.loss));
}

DepthNoiseModel NoiseFor(const OdometrySettings& settings,
                         const RgbdCamera& camera) {
  if (settings.depth_noise.has_value()) return *settings.depth_noise;
  return camera.depth_noise.value_or(DepthLookupOptions().noise);
}

FrontendOptions FeaturesFor(const OdometrySettings& settings,
                            const RgbdCamera& camera) {
  FrontendOptions features = settings.features;
  features.camera = camera.camera;
  features.depth.noise = NoiseFor(settings, camera);
  return features;
}

std::unique_ptr<Tracker> MakeTracker(const OdometrySettings& settings,
                                     const RgbdCamera& camera,
                                     std::optional<Estimator> own) {
  const FrontendOptions features = FeaturesFor(settings, camera);
  DirectSettings direct = settings.direct;
  direct.points.min_depth = features.depth.min_depth;
  direct.points.max_depth = features.depth.max_depth;
  return MakeTracker(
      own.has_value() ? "features" : settings.tracker,
      {settings.tracking, features, settings.frontend,
       own.has_value() ? *std::move(own) : MakeEstimator(settings.estimator),
       MakeDirectEstimators(settings.estimator, direct)});
}

Odometry MakeOdometry(const OdometrySettings& settings,
                      const RgbdCamera& camera, std::optional<Estimator> own) {
  return Odometry(settings.odometry,
                  MakeTracker(settings, camera, std::move(own)));
}

std::vector<Setting> SettingTable(OdometrySettings* settings) {
  EstimatorSettings* estimator = &settings->estimator;
  EstimatorOptions* options = &estimator->options;
  FrontendOptions* features = &settings->features;
  TrackerOptions* tracking = &settings->tracking;
  OdometryOptions* odometry = &settings->odometry;
  DirectSettings* direct = &settings->direct;
  return {
      {"cost", kEstimationGroup, "cost of a match; a+b adds costs",
       &estimator->cost, CostNames()},
      {"loss", kEstimationGroup,
       "M-estimator, optionally with its width in sigmas: huber(1.5); with "
       "several costs one for each: a,b",
       &estimator->loss, MEstimatorNames()},
      {"scale", kEstimationGroup,
       "scale of the residuals: from the noise model (fixed) or estimated; for "
       "the units of depth images see depth_scale",
       ScaleByName(&options->scale), NamesOf(ScaleEstimators())},
      {"robust_schedule", kEstimationGroup,
       "direct: losses have their final width from the start; gnc: they start "
       "wide and are narrowed step by step",
       ByName(kRobustSchedules, "robust schedule", &options->schedule),
       NamesOf(kRobustSchedules)},
      {"gnc_factor", kEstimationGroup,
       "factor by which each step of robust_schedule=gnc narrows the losses",
       &options->gnc_factor},
      {"max_iterations", kEstimationGroup,
       "maximum number of solver iterations in the last stage",
       &options->max_iterations},
      {"min_inlier_share", kEstimationGroup,
       "a motion with a smaller share of inliers is inconsistent",
       &options->min_inlier_share},
      {"max_scale", kEstimationGroup,
       "a motion whose residuals spread wider than this (in sigmas) is "
       "inconsistent",
       &options->max_scale},
      {"max_standard_deviation", kEstimationGroup,
       "a motion with a direction less certain than this (rad or m) is "
       "degenerate",
       &options->max_standard_deviation},
      {"depth_noise", kEstimationGroup,
       "depth noise: a model, or a file written by rgbd_calibrate; camera: "
       "that of the camera file or preset, khoshelham if it has none",
       DepthNoiseByName(&settings->depth_noise), DepthNoiseNames()},
      {"assembly", kEstimationGroup, "how matches become Ceres residual blocks",
       ByName(kAssemblies, "assembly", &options->assembly),
       NamesOf(kAssemblies)},
      {"frontend", kFeatures, "how features are matched", &settings->frontend,
       FrontendNames()},
      {"max_features", kFeatures, "features wanted in a reference frame",
       &features->max_features},
      {"feature_noise", kFeatures,
       "noise of features in the image, as a factor of what the frontend "
       "states; rgbd_calibrate measures it",
       &features->feature_noise},
      {"min_depth", kFeatures, "smaller depths (m) are ignored",
       &features->depth.min_depth},
      {"max_depth", kFeatures, "larger depths (m) are ignored",
       &features->depth.max_depth},
      {"tracker", kTracking,
       "how a frame is tracked: by features, pixels or both",
       &settings->tracker, TrackerNames()},
      {"direct_cost", kTracking, "cost of a pixel; a+b adds costs",
       &direct->cost, DirectCostNames()},
      {"direct_loss", kTracking,
       "M-estimator of pixels in the last step; with several costs one for "
       "each",
       &direct->loss, MEstimatorNames()},
      {"direct_points", kTracking,
       "pixels compared for each cost; 0: the cost's default",
       &direct->points.max_points},
      {"direct_levels", kTracking,
       "number of pyramid levels at which pixels are compared",
       &direct->points.num_levels},
      {"direct_information", kTracking,
       "weight of a pixel's information, from 0 to 1; 0: the cost's default, "
       "which gives correct covariances",
       &direct->points.information_factor},
      {"min_seen_share", kTracking,
       "a frame tracked by pixels is lost if a smaller share of its reference "
       "frame is visible",
       &tracking->min_seen_share},
      {"initial_guess", kTracking, "where the solver starts in a frame",
       GuessByName(tracking), GuessNames()},
      {"on_lost", kTracking,
       "what to do with lost frames; except with stop, they are also searched "
       "for among earlier reference frames",
       ByName(kLostPolicies, "policy", &odometry->on_lost),
       NamesOf(kLostPolicies)},
      {"shutter", kTracking,
       "rolling shutters, and depth taken at another time than colour: camera: "
       "compensate them as the camera and the time stamps specify; none: "
       "ignore them",
       ByName(kShutterUses, "shutter", &odometry->shutter),
       NamesOf(kShutterUses)},
      {"new_segment_after", kTracking,
       "how long (s) the previous segment is searched for after a new one has "
       "started",
       &odometry->new_segment_after},
      {"guess_sigma_rotation", kTracking,
       "standard deviation (rad) of the rotation of motion_guess between two "
       "frames",
       &odometry->guess_sigma_rotation},
      {"guess_sigma_translation", kTracking,
       "standard deviation (m) of the translation of motion_guess between "
       "two frames",
       &odometry->guess_sigma_translation},
      {"min_inliers", kTracking, "a frame with fewer inliers is lost",
       &tracking->min_inliers},
      {"min_inliers_ok", kTracking, "a frame with fewer inliers is degraded",
       &tracking->min_inliers_ok},
      {"min_inlier_share_ok", kTracking,
       "a frame with a smaller share of inliers is degraded",
       &tracking->min_inlier_share_ok},
      {"max_sigma_ok", kTracking,
       "a frame whose residuals spread wider than this (in sigmas) is degraded",
       &tracking->max_sigma_ok},
      {"min_reference_share", kTracking,
       "a new reference frame is chosen if a smaller share of its features are "
       "inliers",
       &odometry->min_reference_share},
      {"max_flow_px", kTracking,
       "a new reference frame is chosen if the inliers have moved farther than "
       "this on average (px)",
       &odometry->max_flow_px},
      {"prior_sigma_rotation", kTracking,
       "standard deviation (rad) of the rotation between two frames, for "
       "cost=...+motion_prior",
       &tracking->prior_sigma_rotation},
      {"prior_sigma_translation", kTracking,
       "standard deviation (m) of the translation between two frames, for "
       "cost=...+motion_prior",
       &tracking->prior_sigma_translation},
  };
}

}  // namespace rgbd_pose
