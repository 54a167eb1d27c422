#include "core/geometry/depth_noise.h"

namespace rgbd_pose {
namespace {

double Khoshelham(double depth) { return 1.425e-3 * depth * depth; }

double Nguyen(double depth) {
  const double beyond = depth - 0.4;
  return 0.0012 + 0.0019 * beyond * beyond;
}

double Constant(double /*depth*/) { return 0.005; }

}  // namespace

const std::vector<DepthNoiseModel>& DepthNoiseModels() {
  static const std::vector<DepthNoiseModel>& models =
      *new std::vector<DepthNoiseModel>{
          {"khoshelham", Khoshelham},
          {"nguyen", Nguyen},
          {"constant", Constant},
      };
  return models;
}

const DepthNoiseModel* FindDepthNoiseModel(std::string_view name) {
  for (const DepthNoiseModel& model : DepthNoiseModels()) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

std::vector<std::string> DepthNoiseModelNames() {
  std::vector<std::string> names;
  for (const DepthNoiseModel& model : DepthNoiseModels()) {
    names.emplace_back(model.name);
  }
  return names;
}

}  // namespace rgbd_pose
