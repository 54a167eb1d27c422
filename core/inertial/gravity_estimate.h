#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "core/inertial/imu_calibration.h"
#include "core/inertial/mean_force.h"

namespace rgbd_pose {

// Which way is up in a world.
struct GravityEstimate {
  std::string refusal;  // why this is not known, in a line; empty if it is

  // In the world, of length 1, with the standard deviation of its angle across
  // the least certain horizontal axis, rad.
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  double sigma = 0.0;

  // What the accelerometer measures more than it should, in the axes of the
  // camera, m/s^2, and its covariance: what the turns of the camera tell apart
  // from gravity. An error of the mounting is mostly found as this, too.
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  Eigen::Matrix3d bias_covariance = Eigen::Matrix3d::Zero();

  // The standard deviation, m/s^2, of what the uncertain bias changes in the
  // means of the path, less what it changes in all of them alike.
  double bias_effect = 0.0;

  double acceleration = 0.0;  // of gravity as measured, m/s^2
  double scatter = 0.0;  // standard deviation of each axis of one mean, m/s^2
  int means = 0;         // how many there were
  int segment = 0;       // the number of the world

  // Whether it is known.
  bool ok() const { return refusal.empty(); }
};

// The standard deviation of each axis of an accelerometer's bias before
// anything is measured, m/s^2: what consumer sensors have; 1.2 degrees.
inline constexpr double kAccelBiasSigma = 0.2;

// Estimates gravity s and bias b from means in one world,
//
//   up_in_cam = R^T s + b,
//
// by least squares under Cauchy's loss, with a scale from the residuals. With a
// camera that does not turn, the sigma is that of the bias. A path that drifts
// counts as scatter. Refused if there are fewer than three means, if one is not
// finite, if what they measure is not gravity (free fall, a wrong unit), and if
// they contradict each other.
GravityEstimate EstimateGravity(const std::vector<MeanForce>& forces);

// The same for what a meter measures along paths, world_from_cam, in several
// worlds (segments), by number: in the one with the most poses, the first of
// those. Refused also if the mounting of the sensor is not known.
GravityEstimate EstimateGravity(const ForceMeter& meter,
                                const std::map<int, Trajectory>& paths);

}  // namespace rgbd_pose
