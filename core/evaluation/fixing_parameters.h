#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// How the truth belongs to the estimate: what the clocks differ by, and how the
// body that the truth follows is fixed to the camera.
struct TruthFixing {
  // s: what the estimate has at t, the truth has at t + shift.
  double shift = 0.0;

  // Its translation is the place of the body in the axes of the camera, m.
  Rigid3d camera_from_body;
};

// As parameters, in the order [shift, rotation vector, lever], each in the unit
// in which 1 is a great deal: 20 ms, 2 degrees, 5 cm. What is known no better
// than that is not worth a correction.
using FixingVector = Eigen::Matrix<double, 7, 1>;
using FixingMatrix = Eigen::Matrix<double, 7, 7>;

// The units, in s, rad and m.
FixingVector FixingUnits();

// What the parameters say, in s, rad and m.
TruthFixing FixingAt(const FixingVector& x);

// Names directions of the parameters, the columns of a matrix of orthonormal
// ones: "time shift", "rotation about (0.00, 0.00, 1.00)", "lever", ...
std::vector<std::string> NameFixingDirections(
    const Eigen::Matrix<double, 7, Eigen::Dynamic>& directions);

}  // namespace rgbd_pose
