#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rgbd_pose {

// How uncertain one measured depth is.
struct DepthNoiseModel {
  std::string_view name;          // as programs take it
  double (*sigma)(double depth);  // standard deviation (m) at a depth (m)
};

// All depth noise models:
//   khoshelham  1.425e-3 z^2, Kinect v1 (Khoshelham & Elberink 2012)
//   nguyen      0.0012 + 0.0019 (z - 0.4)^2, Kinect v1, head on (Nguyen, Izadi
//               & Lovell 2012)
//   constant    5 mm, for sensors nothing is known of
const std::vector<DepthNoiseModel>& DepthNoiseModels();

// The model of that name, or null.
const DepthNoiseModel* FindDepthNoiseModel(std::string_view name);

// The names of all models.
std::vector<std::string> DepthNoiseModelNames();

}  // namespace rgbd_pose
