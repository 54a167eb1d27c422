#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/inertial/camera_imu.h"
#include "core/inertial/gravity_estimate.h"

namespace rgbd_pose {

// The object `gravity` of metrics.json.
nlohmann::json GravityToJson(const GravityEstimate& gravity);

// The object `gyroscope` of metrics.json.
nlohmann::json GyroscopeToJson(const CameraImu& imu);

// Describe these objects in one line each, for printing.
std::string FormatGravity(const nlohmann::json& gravity);
std::string FormatGyroscope(const nlohmann::json& gyroscope);

}  // namespace rgbd_pose
