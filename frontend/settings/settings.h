#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/geometry/camera.h"
#include "core/util/setting.h"
#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/odometry.h"
#include "frontend/tracking/tracker_factory.h"

namespace rgbd_pose {

// The parts of an estimator. Defaults are the defaults of the parts.
struct EstimatorSettings {
  std::string cost = kDefaultCost;  // of a match; "a+b" adds two
  std::string loss = kDefaultLoss;  // one for all costs, or one each: "a,b"
  EstimatorOptions options;         // settings of the minimisation
};

// The parts of an estimator that aligns pixels directly.
struct DirectSettings {
  std::string cost = kDefaultDirectCost;  // of a pixel; "a+b" adds two
  std::string loss = kDefaultDirectLoss;  // one for all costs, or one each
  DirectOptions points;                   // selection of pixels
  EstimatorOptions options = DirectEstimatorOptions();  // of the minimisation
};

// All settings of an odometry, for programs, Python and benchmarks alike.
// SettingTable names each value that users may want to set.
struct OdometrySettings {
  EstimatorSettings estimator;     // estimates motion from matches
  std::string frontend = "patch";  // source of the matches
  FrontendOptions features;        // without the camera and its depth noise
  std::string tracker = "hybrid";  // tracking method
  TrackerOptions tracking;         // validation of the estimates
  DirectSettings direct;           // estimates motion from pixels
  OdometryOptions odometry;        // keyframes, lost frames

  // Noise of depth; nothing: that of the camera (see NoiseFor).
  std::optional<DepthNoiseModel> depth_noise;
};

// The depth noise of the settings, or else that of the camera, or else that of
// an unknown camera.
DepthNoiseModel NoiseFor(const OdometrySettings& settings,
                         const RgbdCamera& camera);

// `settings.features` with the camera and its depth noise (NoiseFor) filled in:
// what reads the depths of a recording needs these, not the settings alone.
FrontendOptions FeaturesFor(const OdometrySettings& settings,
                            const RgbdCamera& camera);

// Create an estimator, tracker or odometry with these settings. Throw
// InputError for unknown names and invalid values.
//
// `own`: estimates each motion from matches, instead of `settings.estimator`,
// and thus with any cost. Pixels then give only the start, as with the tracker
// "features", whatever `settings.tracker` is: in a sum with pixels the cost of
// the settings would decide as well.
Estimator MakeEstimator(const EstimatorSettings& settings);
std::unique_ptr<Tracker> MakeTracker(
    const OdometrySettings& settings, const RgbdCamera& camera,
    std::optional<Estimator> own = std::nullopt);
Odometry MakeOdometry(const OdometrySettings& settings,
                      const RgbdCamera& camera,
                      std::optional<Estimator> own = std::nullopt);

// The group of the settings that concern only matches.
inline constexpr char kEstimationGroup[] = "Estimation";

// All settings in the order of --help. `settings` must outlive the rows.
std::vector<Setting> SettingTable(OdometrySettings* settings);

}  // namespace rgbd_pose
