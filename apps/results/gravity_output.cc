#include "apps/results/gravity_output.h"

#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {

nlohmann::json GravityToJson(const GravityEstimate& gravity) {
  nlohmann::json json = {{"refusal", gravity.refusal},
                         {"means", gravity.means}};
  if (!gravity.ok()) return json;
  const auto list = [](const Eigen::Vector3d& v) {
    return nlohmann::json{v.x(), v.y(), v.z()};
  };
  json["up"] = list(gravity.up);
  json["sigma_deg"] = kDegreesPerRadian * gravity.sigma;
  json["segment"] = gravity.segment;
  json["acceleration"] = gravity.acceleration;
  json["scatter"] = gravity.scatter;
  json["accel_bias"] = list(gravity.bias);
  json["accel_bias_sigma"] =
      list(gravity.bias_covariance.diagonal().cwiseSqrt());
  return json;
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

}  // namespace rgbd_pose
