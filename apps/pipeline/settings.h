#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/geometry/camera.h"
#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/odometry.h"
#include "frontend/tracking/tracker_factory.h"

namespace rgbd_pose {

// What an estimator is made of. Defaults are those of the parts.
struct EstimatorSettings {
  std::string cost = kDefaultCost;  // of a match; several add up: "a+b"
  std::string loss = kDefaultLoss;  // one for all costs or one each: "a,b"
  EstimatorOptions options;         // how it is minimised
};

// What an estimator of pixels is made of.
struct DirectSettings {
  std::string cost = kDefaultDirectCost;  // of a pixel; several add up: "a+b"
  std::string loss = kDefaultDirectLoss;  // one for all costs or one each
  DirectOptions points;                   // which pixels
  EstimatorOptions options = DirectEstimatorOptions();  // how it is minimised
};

// What an odometry is made of: the one place for programs, Python and
// benchmarks. SettingTable gives each value that a user may want a name.
struct OdometrySettings {
  EstimatorSettings estimator;           // what explains the matches
  std::string frontend = "patch";        // where matches come from
  FrontendOptions features;              // without the camera
  std::string tracker = "hybrid";        // how a frame is followed
  TrackerOptions tracking;               // what of that is believed
  DirectSettings direct;                 // what explains the pixels
  DirectTrackerOptions direct_tracking;  // what of that is believed
  OdometryOptions odometry;              // when to go on, and what if lost
};

// An estimator, tracker or odometry with these settings. Throws InputError for
// unknown names and values that make no sense.
Estimator MakeEstimator(const EstimatorSettings& settings);
DirectEstimators MakeDirectEstimators(const EstimatorSettings& matches,
                                      const DirectSettings& pixels);
std::unique_ptr<Tracker> MakeTracker(const OdometrySettings& settings,
                                     const Camera& camera);
Odometry MakeOdometry(const OdometrySettings& settings, const Camera& camera);

// A value that is set by its name in some table.
struct NamedSetting {
  std::function<std::string()> get;             // the name it has now
  std::function<void(const std::string&)> set;  // InputError if unknown
};

// A value of the settings, for flags, keyword arguments and whatever else sets
// them: one row here is all that it takes.
struct Setting {
  const char* name;        // as users write it
  std::string_view group;  // of those that belong together
  const char* help;        // what it means, with its unit
  std::variant<int*, double*, bool*, NamedSetting> value;  // what it sets
  std::vector<std::string> choices = {};  // the names there are, if by name
};

// Any text: whether it makes sense is found out where it is used.
NamedSetting Text(std::string* text);

// Rows that are about matches alone.
inline constexpr char kEstimationGroup[] = "Estimation";

// All rows, in the order of --help. They write to the settings, which must
// outlive them.
std::vector<Setting> SettingTable(OdometrySettings* settings);

// A table without the row of that name.
std::vector<Setting> WithoutRow(std::string_view name,
                                std::vector<Setting> table);

}  // namespace rgbd_pose
