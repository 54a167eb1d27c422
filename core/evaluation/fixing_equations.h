#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/evaluation/fixing_parameters.h"
#include "core/evaluation/moving_poses.h"

namespace rgbd_pose {

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
