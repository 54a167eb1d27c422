#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// The shift between the clocks, and the tracked body relative to the camera.
struct TruthFixing {
  // s; time t of the estimate is time t + shift of the truth.
  double shift = 0.0;

  // Its translation is the position of the body in the axes of the camera, m.
  Rigid3d camera_from_body;
};

// The fixing as parameters, in the order [shift, rotation vector, lever], in
// units in which 1 is a large value: 20 ms, 2 degrees, 5 cm.
using FixingVector = Eigen::Matrix<double, 7, 1>;
using FixingMatrix = Eigen::Matrix<double, 7, 7>;
// Orthonormal directions of the parameters, as columns.
using FixingDirections = Eigen::Matrix<double, 7, Eigen::Dynamic>;

// The units, in s, rad and m.
FixingVector FixingUnits();

// Converts parameters to a fixing in s, rad and m.
TruthFixing FixingAt(const FixingVector& x);

// Names directions of the parameters: "time shift", "rotation about (0.00,
// 0.00, 1.00)", "lever", ...
std::vector<std::string> NameFixingDirections(
    const FixingDirections& directions);

struct MovingPose {
  Rigid3d world_from_cam;
  Twist velocity;  // in the camera's own axes, rad/s and m/s
};

// The poses at these times (s) with velocities from the previous to the next
// pose; nothing where one of the three is missing or they are too far apart.
std::vector<std::optional<MovingPose>> MovingPoses(
    const std::vector<double>& times,
    const std::vector<std::optional<Rigid3d>>& poses);

// The motion from one pose to a later one, in the axes of the first, and its
// rate of change when both poses are shifted to a later time.
struct PoseChange {
  PoseChange(const MovingPose& from, const MovingPose& to);

  Eigen::Matrix3d rotation;     // from_from_to
  Eigen::Vector3d turn;         // the same as a rotation vector, rad
  Eigen::Vector3d translation;  // m
  Twist rate;                   // of turn (first order) and translation
};

// One camera motion in the estimate and, for some fixing, in the truth.
struct ComparedMotion {
  double start = 0.0;  // s
  PoseChange estimate;
  PoseChange truth;
};

// Normal equations, in units of FixingVector, of the differences between
// estimated and true motions, whitened by their own spread and robust (Tukey).
struct FixingEquations {
  // `lever` (m) is the lever of the fixing. Motions must be in time order and
  // last `overlap` seconds: motions that overlap in time are not independent.
  FixingEquations(const std::vector<ComparedMotion>& motions,
                  const Eigen::Vector3d& lever, double overlap);

  // Number of motions used: all except outliers.
  int used() const { return static_cast<int>(rows_.size()); }

  // Returns the directions that the motions determine to better than `limit`
  // (in units of FixingVector), and the others in `rest`. Only motion in both
  // counts: at least `min_agreement` (0 to 1, like a correlation) of each.
  FixingDirections Determined(double limit, double min_agreement,
                              FixingDirections* rest) const;

  // The covariance of the gradient, from differences correlated over time.
  FixingMatrix GradientCovariance() const;

  // A small step towards the minimum is hessian^-1 gradient.
  FixingMatrix hessian = FixingMatrix::Zero();
  FixingVector gradient = FixingVector::Zero();

 private:
  // A motion's contribution to the gradient.
  struct Row {
    double start;
    FixingVector gradient;
  };

  std::vector<Row> rows_;
  double overlap_;                                   // s
  FixingMatrix by_estimate_ = FixingMatrix::Zero();  // J_estimate^T J_estimate
  FixingMatrix agreed_ = FixingMatrix::Zero();       // J_truth^T J_estimate
};

}  // namespace rgbd_pose
