#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/evaluation/moving_poses.h"
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

// The same motion by the estimate and by the truth, as it is with some fixing
// to the camera.
struct ComparedMotion {
  double start = 0.0;  // s
  PoseChange estimate;
  PoseChange truth;
};

// Normal equations, in units of FixingVector, of the differences between
// estimated and true motions, whitened by their own spread and robust (Tukey).
class FixingEquations {
 public:
  // `lever` (m) is that of the fixing. Motions are in time order and take
  // `overlap` seconds, so that those that start within it are not independent.
  FixingEquations(const std::vector<ComparedMotion>& motions,
                  const Eigen::Vector3d& lever, double overlap);

  // Of the motions that count: those that are not far off.
  int used() const { return static_cast<int>(rows_.size()); }

  const FixingMatrix& hessian() const { return hessian_; }

  // By which a small step towards the minimum is hessian^-1 gradient.
  const FixingVector& gradient() const { return gradient_; }

  // The directions that the motions determine to better than `limit` (in units
  // of FixingVector), as orthonormal columns, and, in `rest`, the others. Noise
  // of either trajectory feigns motion, but not the same one: what counts is
  // the motion that both have, and it has to be at least `min_agreement` (0 to
  // 1, as a coefficient of correlation) of what they have one by one.
  Eigen::Matrix<double, 7, Eigen::Dynamic> Determined(
      double limit, double min_agreement,
      Eigen::Matrix<double, 7, Eigen::Dynamic>* rest) const;

  // The covariance that the differences themselves show: they are correlated
  // over time, and are not as large as each other.
  FixingMatrix GradientCovariance() const;

 private:
  // A motion's share of the gradient.
  struct Row {
    double start;
    FixingVector gradient;
  };

  std::vector<Row> rows_;
  double overlap_;  // s
  FixingMatrix hessian_ = FixingMatrix::Zero();
  FixingMatrix by_estimate_ = FixingMatrix::Zero();  // hessian by the estimate
  FixingMatrix agreed_ = FixingMatrix::Zero();       // by both, of either one
  FixingVector gradient_ = FixingVector::Zero();
};

}  // namespace rgbd_pose
