#include "frontend/settings/settings.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <type_traits>
#include <variant>

#include "frontend/simulation/synthetic_dataset.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

const Setting& Row(const std::vector<Setting>& table, const std::string& name) {
  for (const Setting& row : table) {
    if (row.name == name) return row;
  }
  throw std::out_of_range(name);
}

TEST(SettingTableTest, EveryRowHasANameOfItsOwn) {
  OdometrySettings settings;
  std::set<std::string> names;
  for (const Setting& row : SettingTable(&settings)) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_STRNE(row.help, "") << row.name;
  }
}

TEST(SettingTableTest, EveryRowIsAPlaceOfItsOwn) {
  OdometrySettings settings;
  std::set<const void*> places;
  for (const Setting& row : SettingTable(&settings)) {
    const auto expect_new = [&](const auto& place) {
      if constexpr (std::is_pointer_v<std::decay_t<decltype(place)>>) {
        EXPECT_TRUE(places.insert(place).second) << row.name;
      }
    };
    std::visit(expect_new, row.value);
  }
}

TEST(SettingTableTest, EveryChoiceIsTakenAndToldAgain) {
  OdometrySettings settings;
  for (const Setting& row : SettingTable(&settings)) {
    // A text takes anything, and says what is valid.
    if (std::holds_alternative<std::string*>(row.value)) {
      EXPECT_FALSE(row.choices.empty()) << row.name;
      continue;
    }
    const NamedSetting* named = std::get_if<NamedSetting>(&row.value);
    ASSERT_EQ(named == nullptr, row.choices.empty()) << row.name;
    for (const std::string& choice : row.choices) {
      named->set(choice);
      EXPECT_EQ(named->get(), choice) << row.name;
    }
  }
}

TEST(SettingTableTest, NamesReachTheOptions) {
  OdometrySettings settings;
  const std::vector<Setting> table = SettingTable(&settings);
  const auto set = [&table](const char* name, const char* value) {
    std::get<NamedSetting>(Row(table, name).value).set(value);
  };
  set("robust_schedule", "direct");
  set("assembly", "per_match");
  set("initial_guess", "ransac");
  set("on_lost", "hold");
  EXPECT_EQ(settings.estimator.options.schedule, RobustSchedule::kDirect);
  EXPECT_EQ(settings.estimator.options.assembly, Assembly::kPerMatch);
  EXPECT_EQ(settings.tracking.initial_guess->name, "ransac");
  EXPECT_EQ(settings.odometry.on_lost, LostPolicy::kHold);
  set("initial_guess", "last");
  EXPECT_EQ(settings.tracking.initial_guess, nullptr);
  ExpectInputError([&] { set("initial_guess", "velocity"); },
                   {"initial guess", "'velocity'", "last", "ransac"});
  ExpectInputError([&] { set("scale", "iqr"); }, {"scale", "'iqr'", "mad"});
}

TEST(NoiseForTest, IsThatOfTheCameraUnlessOneIsChosen) {
  OdometrySettings settings;
  const RgbdCamera kinect = *CameraPreset("tum_fr1");
  EXPECT_EQ(NoiseFor(settings, kinect).name, "kinect");
  EXPECT_EQ(NoiseFor(settings, {}).sigma(2.0),
            FindNamed(DepthNoiseModels(), "khoshelham")->sigma(2.0));
  EXPECT_EQ(MakeTracker(settings, kinect)->images().depth.noise.name, "kinect");
  settings.depth_noise = *FindNamed(DepthNoiseModels(), "nguyen");
  EXPECT_EQ(FeaturesFor(settings, kinect).depth.noise.name, "nguyen");
}

// The position (m) of the last of a few frames.
Eigen::Vector3d LastPosition(Odometry odometry) {
  const SyntheticDataset room({"room", "pan_tilt", 4});
  for (int i = 0; i < room.size(); ++i) odometry.Track(room.Read(i));
  return odometry.WorldFromCam().translation;
}

TEST(MakeOdometryTest, AnEstimatorOfOnesOwnDeterminesTheMotion) {
  const RgbdCamera camera = SyntheticDataset({"room", "pan_tilt", 1}).camera();
  OdometrySettings huber;
  huber.estimator.loss = "huber";
  const Eigen::Vector3d refined = LastPosition(MakeOdometry(huber, camera));
  huber.tracker = "features";
  const Eigen::Vector3d by_name = LastPosition(MakeOdometry(huber, camera));
  EXPECT_NE(by_name, refined);
  EXPECT_EQ(
      LastPosition(MakeOdometry({}, camera, MakeEstimator(huber.estimator))),
      by_name);
}

TEST(SettingTableTest, WhatMakesNoSenseMakesNoOdometry) {
  const auto refused = [](const char* name, double value) {
    OdometrySettings settings;
    const std::vector<Setting> table = SettingTable(&settings);
    const Setting row = Row(table, name);
    if (int* const* whole = std::get_if<int*>(&row.value)) {
      **whole = static_cast<int>(value);
    } else {
      *std::get<double*>(row.value) = value;
    }
    ExpectInputError([&] { MakeOdometry(settings, {}); }, {name});
  };
  refused("gnc_factor", 1.0);
  refused("max_iterations", 0.0);
  refused("max_features", 2.0);
  refused("feature_noise", 0.0);
  refused("min_inliers", 2.0);
  refused("max_flow_px", 0.0);
  refused("new_segment_after", -1.0);
}

}  // namespace
}  // namespace rgbd_pose
