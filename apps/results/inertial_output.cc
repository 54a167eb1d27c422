#include "apps/results/inertial_output.h"

#include <nlohmann/json.hpp>

#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

nlohmann::json List(const Eigen::Vector3d& v) {
  return nlohmann::json{v.x(), v.y(), v.z()};
}

}  // namespace

nlohmann::json GravityToJson(const GravityEstimate& gravity) {
  nlohmann::json json = {{"refusal", gravity.refusal},
                         {"means", gravity.means}};
  if (!gravity.ok()) return json;
  json["up"] = List(gravity.up);
  json["sigma_deg"] = kDegreesPerRadian * gravity.sigma;
  json["segment"] = gravity.segment;
  json["acceleration"] = gravity.acceleration;
  json["scatter"] = gravity.scatter;
  json["accel_bias"] = List(gravity.bias);
  json["accel_bias_sigma"] =
      List(gravity.bias_covariance.diagonal().cwiseSqrt());
  return json;
}

nlohmann::json GyroscopeToJson(const CameraImu& imu) {
  const CameraImu::State& state = imu.state();
  const CameraImu::State sigma = imu.covariance().diagonal().cwiseSqrt();
  const ImuCalibration calibration = imu.Calibration();
  const Eigen::Quaterniond& turn = calibration.cam_from_imu->rotation;
  return {
      {"doubt", imu.doubt()},
      {"turns", imu.num_learnt()},
      {"bias", List(state.head<3>())},
      {"bias_sigma", List(sigma.head<3>())},
      {"delay_ms", 1e3 * *calibration.delay_s},
      {"delay_sigma_ms", 1e3 * sigma[3]},
      {"cam_from_imu_quaternion", {turn.x(), turn.y(), turn.z(), turn.w()}},
      {"mounting_off_deg", kDegreesPerRadian * state.tail<3>().norm()},
      {"mounting_sigma_deg", kDegreesPerRadian * sigma.tail<3>().maxCoeff()}};
}

std::string FormatGravity(const nlohmann::json& gravity) {
  const std::string refusal = gravity.at("refusal");
  if (!refusal.empty()) return "gravity     not determined: " + refusal + "\n";
  const nlohmann::json& up = gravity.at("up");
  return Format(
      "gravity     up is (%.4f %.4f %.4f) in the world, sigma %.2g degrees\n",
      up[0].get<double>(), up[1].get<double>(), up[2].get<double>(),
      gravity.at("sigma_deg").get<double>());
}

std::string FormatGyroscope(const nlohmann::json& gyroscope) {
  const std::string doubt = gyroscope.at("doubt");
  if (!doubt.empty()) return "gyroscope   not used: " + doubt + "\n";
  const auto number = [&](const char* key) {
    return gyroscope.at(key).get<double>();
  };
  return Format(
      "gyroscope   delay %.1f ms, sigma %.2g; mounting off by %.2f degrees, "
      "sigma %.2g\n",
      number("delay_ms"), number("delay_sigma_ms"), number("mounting_off_deg"),
      number("mounting_sigma_deg"));
}

}  // namespace rgbd_pose
