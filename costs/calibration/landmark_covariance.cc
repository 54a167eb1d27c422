#include "costs/calibration/landmark_covariance.h"

#include <Eigen/Cholesky>

#include "costs/calibration/known_distance_block.h"
#include "costs/calibration/landmark_equations.h"

namespace rgbd_pose {

bool LandmarkCovariance(const CalibrationViews& views, bool training_only,
                        const CalibrationOrigin& origin, double loss_width,
                        const CalibrationState& state,
                        CalibrationMatrix* by_noise,
                        CalibrationMatrix* by_scatter) {
  by_noise->setZero();
  by_scatter->setZero();
  const std::vector<MotionDerivatives> poses = PosesOf(state);
  const int num_poses = static_cast<int>(poses.size());
  LandmarkEquations equations = MakeLandmarkEquations(
      views, training_only, origin, loss_width, state, poses);
  Eigen::MatrixXd& H = equations.hessian;
  const int size = static_cast<int>(H.rows());
  const int y_at = equations.PlaceOfY();
  const auto place_of = [](int keyframe) {
    return LandmarkEquations::PlaceOfPose(keyframe);
  };
  for (const KnownDistance& known : views.distances) {
    const KnownDistanceError error(poses[known.a], poses[known.b],
                                   state.theta[kDepthFactor], known);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    if (known.a > 0) row.segment<6>(place_of(known.a)) += error.a.transpose();
    if (known.b > 0) row.segment<6>(place_of(known.b)) += error.b.transpose();
    row[y_at + kDepthFactor] += error.by_factor * origin.width[kDepthFactor];
    H.noalias() += row * row.transpose();
  }
  for (int k = 0; k < kCalibrationSize; ++k) H(y_at + k, y_at + k) += 1.0;
  // Poses that nothing sees.
  for (int k = 0; k < y_at; ++k) H(k, k) += 1e-9;

  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> cholesky(H);
  if (cholesky.info() != Eigen::Success) return false;
  Eigen::MatrixXd last = Eigen::MatrixXd::Zero(size, kCalibrationSize);
  last.bottomRows<kCalibrationSize>().setIdentity();
  cholesky.solveInPlace(last);
  const auto scale = origin.width.asDiagonal();
  *by_noise = scale * last.bottomRows<kCalibrationSize>() * scale;
  // What each keyframe's landmarks move y by.
  Eigen::MatrixXd moves = last.transpose() * equations.gradients;
  // Distances and the prior have the noise that they say.
  CalibrationMatrix exact = last.bottomRows<kCalibrationSize>().transpose() *
                            last.bottomRows<kCalibrationSize>();
  for (const KnownDistance& known : views.distances) {
    const KnownDistanceError error(poses[known.a], poses[known.b],
                                   state.theta[kDepthFactor], known);
    CalibrationVector move = last.row(y_at + kDepthFactor).transpose() *
                             error.by_factor * origin.width[kDepthFactor];
    if (known.a > 0) {
      move += last.middleRows<6>(place_of(known.a)).transpose() *
              error.a.transpose();
    }
    if (known.b > 0) {
      move += last.middleRows<6>(place_of(known.b)).transpose() *
              error.b.transpose();
    }
    exact += move * move.transpose();
  }
  int groups = 0;
  for (int k = 0; k < num_poses; ++k) groups += moves.col(k).norm() > 0.0;
  const double correction =
      groups > 1 ? static_cast<double>(groups) / (groups - 1) : 1.0;
  *by_scatter =
      scale * (correction * moves * moves.transpose() + exact) * scale;
  return by_noise->allFinite() && by_scatter->allFinite();
}

}  // namespace rgbd_pose
