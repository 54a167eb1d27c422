#pragma once

#include <string>
#include <vector>

#include "core/util/named_values.h"

namespace rgbd_pose {

// Noise of one measured depth: sigma(z) = constant + quadratic (z - centre)^2.
// For a structured-light or stereo camera the quadratic part dominates: an
// error of disparity is an error of inverse depth.
struct DepthNoiseModel {
  std::string name;        // as given to programs: of the table, or of a file
  double constant = 0.0;   // m
  double quadratic = 0.0;  // 1/m
  double centre = 0.0;     // m

  // Sigma of the mean of 3 x 3 neighbours, as a fraction of a single pixel's:
  // 1/3 if their errors are independent, 1 if equal (assumed if unknown).
  double mean_share = 1.0;

  // The standard deviation (m) at a depth (m).
  double sigma(double depth) const {
    const double beyond = depth - centre;
    return constant + quadratic * beyond * beyond;
  }

  // One line that says what is wrong with the numbers, or empty. The default
  // values are invalid: sigma must be above 0 at every depth.
  std::string Check() const;
};

// All depth noise models, for FindNamed:
//   kinect      0.0008 + 0.0029 z^2, Kinect v1 where features are; neighbours
//               err alike (rgbd_calibrate with real recordings)
//   khoshelham  1.425e-3 z^2, Kinect v1 (Khoshelham & Elberink 2012)
//   nguyen      0.0012 + 0.0019 (z - 0.4)^2, Kinect v1, head on (Nguyen, Izadi
//               & Lovell 2012)
//   constant    5 mm, for unknown sensors
const std::vector<DepthNoiseModel>& DepthNoiseModels();

}  // namespace rgbd_pose
