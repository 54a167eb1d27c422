#include "costs/calibration/landmark_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "costs/calibration/known_distance_block.h"

namespace rgbd_pose {
namespace {

// As RobustCovariance has it.
constexpr double kMinSlope = 0.2;

}  // namespace

bool LandmarkCovariance(const CalibrationViews& views, bool training_only,
                        const CalibrationOrigin& origin,
                        const CalibrationState& state,
                        CalibrationMatrix* model_covariance,
                        CalibrationMatrix* sandwich_covariance) {
  model_covariance->setZero();
  sandwich_covariance->setZero();
  const std::vector<MotionDerivatives> poses = PosesOf(state);
  const int num_poses = static_cast<int>(poses.size());
  const ReducedCameraSystem equations =
      MakeReducedCameraSystem(views, training_only, origin, state, poses);
  const int size = static_cast<int>(equations.hessian.rows());
  Eigen::MatrixXd known_before = Eigen::MatrixXd::Zero(size, size);
  const int y_at = equations.PlaceOfY();
  const auto place_of = [](int keyframe) {
    return ReducedCameraSystem::PlaceOfPose(keyframe);
  };
  for (const KnownDistance& known : views.distances) {
    const KnownDistanceError error(poses[known.a], poses[known.b],
                                   state.theta[kDepthFactor], known);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    if (known.a > 0) row.segment<6>(place_of(known.a)) += error.a.transpose();
    if (known.b > 0) row.segment<6>(place_of(known.b)) += error.b.transpose();
    row[y_at + kDepthFactor] += error.by_factor * origin.width[kDepthFactor];
    known_before.noalias() += row * row.transpose();
  }
  known_before.diagonal().tail<kCalibrationSize>().array() += 1.0;
  // Poses that nothing sees.
  known_before.diagonal().head(y_at).array() += 1e-9;

  // The last columns of the inverse.
  Eigen::MatrixXd last;
  const auto invert = [&](double slope) {
    Eigen::MatrixXd H = slope * equations.hessian + known_before;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> cholesky(H);
    last = Eigen::MatrixXd::Zero(size, kCalibrationSize);
    last.bottomRows<kCalibrationSize>().setIdentity();
    cholesky.solveInPlace(last);
    return cholesky.info() == Eigen::Success;
  };
  const auto scale = origin.width.asDiagonal();
  if (!invert(1.0)) return false;
  *model_covariance = scale * last.bottomRows<kCalibrationSize>() * scale;
  const double slope =
      equations.weight_p > 0.0 ? equations.slope_p / equations.weight_p : 1.0;
  if (!invert(std::max(slope, kMinSlope))) return false;
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
  *sandwich_covariance =
      scale * (correction * moves * moves.transpose() + exact) * scale;
  return model_covariance->allFinite() && sandwich_covariance->allFinite();
}

}  // namespace rgbd_pose
