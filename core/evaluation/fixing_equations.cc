#include "core/evaluation/fixing_equations.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/motion.h"
#include "core/util/format.h"
#include "core/util/quantile.h"
#include "core/util/small_matrix.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

// A direction is named after time, rotation or lever if their share of its
// squared norm exceeds this; the largest of three shares is at least a third.
constexpr double kNamedShare = 0.3;

// Names the axes that the directions span in three of the parameters.
void NameAxes(const Eigen::Matrix<double, 3, Eigen::Dynamic>& part,
              const std::string& name, const char* relation,
              std::vector<std::string>* names) {
  const auto axes = EigenOf(part * part.transpose());
  if (axes.eigenvalues()[0] > kNamedShare) {
    names->push_back(name);
    return;
  }
  for (int i = 2; i > 0 && axes.eigenvalues()[i] > kNamedShare; --i) {
    Eigen::Vector3d axis = axes.eigenvectors().col(i);
    int largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0.0) axis = -axis;
    names->push_back(name + Format(" %s (%.2f, %.2f, %.2f)", relation, axis.x(),
                                   axis.y(), axis.z()));
  }
}

using FixingJacobian = Eigen::Matrix<double, 6, 7>;

constexpr double kMinSigma = 1e-5;  // rad and m; no camera is better

// Tukey's width for the norm of six whitened differences, about sqrt(6).
constexpr double kTukeyWidth = 7.0;

// Maximum reach of correlations, in motions and as a share of the whole time.
constexpr double kMaxReachMotions = 5.0;
constexpr double kMaxReachShare = 0.1;

// Derivative of the camera's motion with respect to the fixing. If the rotation
// of the body changes, its lever stays constant in the camera's axes.
FixingJacobian MotionByFixing(const PoseChange& motion,
                              const Eigen::Vector3d& lever) {
  const Eigen::Matrix3d& R = motion.rotation;
  FixingJacobian jacobian = FixingJacobian::Zero();
  jacobian.col(0) << motion.rate.angular, motion.rate.linear;
  jacobian.block<3, 3>(0, 1) = -CrossMatrix(motion.turn);
  jacobian.block<3, 3>(3, 1) =
      -CrossMatrix(motion.translation - lever) - R * CrossMatrix(lever);
  jacobian.block<3, 3>(3, 4) = Eigen::Matrix3d::Identity() - R;
  return jacobian;
}

// 1 / sigma of the components of turns and of translations.
MotionVector Whitening(const std::vector<MotionVector>& residuals) {
  std::vector<double> turns, places;
  for (const MotionVector& r : residuals) {
    for (int i = 0; i < 3; ++i) turns.push_back(std::abs(r[i]));
    for (int i = 3; i < 6; ++i) places.push_back(std::abs(r[i]));
  }
  const auto weight = [](std::vector<double>* errors) {
    const double sigma = kSigmaOfMedian * QuantileInPlace(errors, 0.5);
    return 1.0 / std::max(sigma, kMinSigma);
  };
  MotionVector whitening;
  whitening.head<3>().setConstant(weight(&turns));
  whitening.tail<3>().setConstant(weight(&places));
  return whitening;
}

}  // namespace

FixingVector FixingUnits() {
  FixingVector units;
  units << 0.02, Eigen::Vector3d::Constant(2.0 * kRadiansPerDegree),
      Eigen::Vector3d::Constant(0.05);
  return units;
}

TruthFixing FixingAt(const FixingVector& x) {
  const FixingVector value = x.cwiseProduct(FixingUnits());
  const Twist turn{value.segment<3>(1), Eigen::Vector3d::Zero()};
  return {value[0], Rigid3d(turn.MotionDuring(-1.0).rotation, value.tail<3>())};
}

std::vector<std::string> NameFixingDirections(
    const FixingDirections& directions) {
  std::vector<std::string> names;
  if (directions.cols() == 0) return names;
  if (directions.row(0).squaredNorm() > kNamedShare) {
    names.emplace_back("time shift");
  }
  NameAxes(directions.middleRows<3>(1), "rotation", "about", &names);
  NameAxes(directions.bottomRows<3>(), "lever", "along", &names);
  return names;
}

std::vector<std::optional<MovingPose>> MovingPoses(
    const std::vector<double>& times,
    const std::vector<std::optional<Rigid3d>>& poses) {
  constexpr double kMaxVelocitySpan = 0.25;  // s
  std::vector<std::optional<MovingPose>> moving(poses.size());
  for (size_t i = 1; i + 1 < poses.size(); ++i) {
    const std::optional<Rigid3d>& before = poses[i - 1];
    const std::optional<Rigid3d>& after = poses[i + 1];
    if (!before || !poses[i] || !after) continue;
    const double seconds = times[i + 1] - times[i - 1];
    if (seconds > kMaxVelocitySpan) continue;
    moving[i] =
        MovingPose{*poses[i],
                   {TwistOf(after->Inverse() * *before, seconds).angular,
                    poses[i]->rotation.conjugate() *
                        (after->translation - before->translation) / seconds}};
  }
  return moving;
}

PoseChange::PoseChange(const MovingPose& from, const MovingPose& to) {
  const Rigid3d change = from.world_from_cam.Inverse() * to.world_from_cam;
  rotation = change.rotation.toRotationMatrix();
  turn = TwistOf(change, -1.0).angular;
  translation = change.translation;
  rate.angular = rotation * to.velocity.angular - from.velocity.angular;
  rate.linear = rotation * to.velocity.linear - from.velocity.linear -
                from.velocity.angular.cross(translation);
}

FixingEquations::FixingEquations(const std::vector<ComparedMotion>& motions,
                                 const Eigen::Vector3d& lever, double overlap)
    : overlap_(overlap) {
  std::vector<MotionVector> residuals;
  for (const ComparedMotion& motion : motions) {
    residuals.emplace_back();
    residuals.back() << motion.estimate.turn - motion.truth.turn,
        motion.estimate.translation - motion.truth.translation;
  }
  const MotionVector whitening = Whitening(residuals);
  for (size_t i = 0; i < motions.size(); ++i) {
    const MotionVector r = whitening.cwiseProduct(residuals[i]);
    const double share = r.squaredNorm() / (kTukeyWidth * kTukeyWidth);
    if (share >= 1.0) continue;
    const MotionVector weights = (1.0 - share) * whitening;  // w = (1 - s)^2
    const auto scaled = [&](const PoseChange& motion) -> FixingJacobian {
      return weights.asDiagonal() * MotionByFixing(motion, lever) *
             FixingUnits().asDiagonal();
    };
    const FixingJacobian by_truth = scaled(motions[i].truth);
    const FixingJacobian by_estimate = scaled(motions[i].estimate);
    hessian += by_truth.transpose() * by_truth;
    by_estimate_ += by_estimate.transpose() * by_estimate;
    agreed_ += by_truth.transpose() * by_estimate;
    rows_.push_back(
        {motions[i].start, by_truth.transpose() * ((1.0 - share) * r)});
    gradient += rows_.back().gradient;
  }
}

FixingDirections FixingEquations::Determined(double limit, double min_agreement,
                                             FixingDirections* rest) const {
  double overlapping = 0.0;  // number of motions that start during one motion
  size_t end = 0;
  for (const Row& row : rows_) {
    while (end < rows_.size() && rows_[end].start < row.start + overlap_) ++end;
    overlapping += end - (&row - rows_.data());
  }
  overlapping = std::max(1.0, overlapping / std::max<size_t>(1, rows_.size()));

  const auto solver =
      EigenOf(0.5 * (agreed_ + agreed_.transpose()) / overlapping);
  FixingDirections directions(7, 7);
  int determined = 0;
  int left = 7;
  for (int i = 6; i >= 0; --i) {
    const FixingVector direction = solver.eigenvectors().col(i);
    const double agreed = solver.eigenvalues()[i];
    const bool is_determined =
        agreed > 1.0 / (limit * limit) &&
        agreed * overlapping >
            min_agreement * std::sqrt(direction.dot(hessian * direction) *
                                      direction.dot(by_estimate_ * direction));
    directions.col(is_determined ? determined++ : --left) = direction;
  }
  *rest = directions.rightCols(7 - determined);
  return directions.leftCols(determined);
}

// Weights correlations down with time (Newey and West, Econometrica 55, 1987).
// The reach must exceed the duration of a motion, as an error of the pose
// between two motions has opposite signs in them, but leave independent spans.
FixingMatrix FixingEquations::GradientCovariance() const {
  const double seconds = rows_.back().start - rows_.front().start;
  const double reach = std::clamp(kMaxReachShare * seconds, 2.0 * overlap_,
                                  kMaxReachMotions * overlap_);
  FixingMatrix covariance = FixingMatrix::Zero();
  for (size_t i = 0; i < rows_.size(); ++i) {
    const FixingVector& g = rows_[i].gradient;
    covariance += g * g.transpose();
    for (size_t j = i + 1; j < rows_.size(); ++j) {
      const double weight = 1.0 - (rows_[j].start - rows_[i].start) / reach;
      if (weight <= 0.0) break;
      const FixingMatrix product = g * rows_[j].gradient.transpose();
      covariance += weight * (product + product.transpose());
    }
  }
  return covariance;
}

}  // namespace rgbd_pose
