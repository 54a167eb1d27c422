#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rgbd_pose {

// How uncertain one measured depth is: its standard deviation is
//
//   sigma(z) = constant + quadratic (z - centre)^2
//
// Of a structured-light or stereo camera the quadratic part is the larger one:
// an error of disparity is one of inverse depth.
struct DepthNoiseModel {
  std::string name;        // as programs take it: of the table, or a file's
  double constant = 0.0;   // m
  double quadratic = 0.0;  // 1/m
  double centre = 0.0;     // m

  // The standard deviation of the mean of 3 x 3 neighbours, as a share of one
  // pixel's: 1/3 if they err independently, 1 if they err alike, as it is taken
  // to be where nothing is known.
  double mean_share = 1.0;

  // The standard deviation (m) at a depth (m).
  double sigma(double depth) const {
    const double beyond = depth - centre;
    return constant + quadratic * beyond * beyond;
  }

  // One line that says what is wrong with the numbers, or empty. Those of a
  // model that nobody has filled in are wrong: no depth is certain.
  std::string Check() const;
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
