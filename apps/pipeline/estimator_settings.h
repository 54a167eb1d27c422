#pragma once

#include <string>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/geometry/depth_noise.h"

namespace rgbd_pose {

// The settings of an estimator by name, as programs and Python take them.
struct EstimatorSettings {
  std::string cost = "bidirectional_point";
  std::string loss = "tukey";
  std::string assembly = "compressed";
  std::string scale = "fixed";
  std::string robust_schedule = "gnc";
};

// The names of assemblies (core/estimation/cost.h) and robust schedules
// (core/estimation/estimator.h).
std::vector<std::string> AssemblyNames();
std::vector<std::string> RobustScheduleNames();

// The options that these settings name, the costs aside. Throws InputError for
// unknown names.
EstimatorOptions MakeEstimatorOptions(const EstimatorSettings& settings);

// The depth noise model of that name. Throws InputError if there is none.
const DepthNoiseModel* DepthNoiseByName(const std::string& name);

}  // namespace rgbd_pose
