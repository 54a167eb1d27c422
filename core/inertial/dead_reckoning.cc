#include "core/inertial/dead_reckoning.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/inertial/gravity_estimate.h"
#include "core/inertial/preintegration.h"

namespace rgbd_pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kGravity = 9.81;  // m/s^2

// What is kept of the path, and the least that is needed, s.
constexpr double kWindow = 2.0;
constexpr double kShortest = 0.3;
constexpr size_t kFewestPoses = 6;

// Gravity differs by this much from place to place, and an accelerometer's
// scale adds to it, m/s^2.
constexpr double kGravitySigma = 0.05;

// Positions are not known better than this, m, whatever their scatter.
constexpr double kLeastSigma = 3e-4;

// Errors of neighbouring poses are alike, as those of their keyframe and of the
// surfaces they see: positions count with a sigma so many times their scatter.
constexpr double kAlike = 3.0;

// What a step of the path adds up to: v and p of the sensor, less what starts
// and gravity add, and their derivatives by the bias. In axes of the world.
struct Sums {
  double seconds = 0.0;
  Vector3d v = Vector3d::Zero(), p = Vector3d::Zero();
  Matrix3d v_by_bias = Matrix3d::Zero(), p_by_bias = Matrix3d::Zero();

  void Add(const Matrix3d& world_from_cam, const PreintegratedMotion& step) {
    const double dt = step.seconds;
    p += dt * v + world_from_cam * step.p;
    p_by_bias +=
        dt * v_by_bias + world_from_cam * step.by_bias.block<3, 3>(6, 3);
    v += world_from_cam * step.v;
    v_by_bias += world_from_cam * step.by_bias.block<3, 3>(3, 3);
    seconds += dt;
  }
};

// The least squares problem over [p(0) v(0) g b], all in axes of the world but
// the bias.
using Start = Eigen::Matrix<double, 12, 1>;
using StartMatrix = Eigen::Matrix<double, 12, 12>;
struct Row {
  Eigen::Matrix<double, 3, 12> by_start;
  Vector3d value;
};

// The covariance of turn x v, in the axes of the start: a wrong turn directs
// forces wrongly, gravity before all. As its error grows from the start, the
// velocity is off by half of that, and the position by t / 6 of it.
Matrix3d CovarianceAcross(const PreintegratedMotion& step,
                          const CameraTurn& turn) {
  const Matrix3d axes = step.start_from_end.toRotationMatrix();
  Matrix3d across;
  const Vector3d& v = step.v;
  across << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  const Matrix3d by_turn = across * axes;
  return by_turn * turn.covariance * by_turn.transpose();
}

Row RowOf(const Sums& sums, const Vector3d& position) {
  Row row;
  const double t = sums.seconds;
  row.by_start << Matrix3d::Identity(), t * Matrix3d::Identity(),
      0.5 * t * t * Matrix3d::Identity(), sums.p_by_bias;
  row.value = position - sums.p;
  return row;
}

}  // namespace

void DeadReckoning::Add(const CameraImu& imu, double stamp,
                        const Rigid3d& world_from_cam) {
  Pose pose = {stamp, world_from_cam, std::nullopt};
  if (!path_.empty()) pose.step = imu.Motion(path_.back().stamp, stamp);
  path_.push_back(pose);
  while (stamp - path_.front().stamp > kWindow) path_.pop_front();
  solution_ = Solve(imu.position());
}

std::optional<double> DeadReckoning::needed_from() const {
  if (path_.empty()) return std::nullopt;
  return path_.front().stamp;
}

std::optional<DeadReckoning::Solution> DeadReckoning::Solve(
    const Vector3d& arm) const {
  // The part of the path for which there are samples.
  size_t first = path_.size() - 1;
  while (first > 0 && path_[first].step.has_value()) --first;
  if (path_.size() - first < kFewestPoses ||
      path_.back().stamp - path_[first].stamp < kShortest) {
    return std::nullopt;
  }
  Sums sums;
  std::vector<Row> rows;
  for (size_t i = first; i < path_.size(); ++i) {
    const Rigid3d& pose = path_[i].world_from_cam;
    rows.push_back(RowOf(sums, pose * arm));
    if (i + 1 == path_.size()) break;
    sums.Add(pose.rotation.toRotationMatrix(), *path_[i + 1].step);
  }
  Start x = Start::Zero();
  x.segment<3>(6) = -kGravity * sums.v.normalized();
  double sigma = 1e-3;
  StartMatrix covariance;
  // The second round knows the scatter of the positions and where gravity is.
  for (int round = 0; round < 2; ++round) {
    StartMatrix H = StartMatrix::Zero();
    Start g = Start::Zero();
    const double weight = 1.0 / (sigma * sigma);
    for (const Row& row : rows) {
      H += weight * row.by_start.transpose() * row.by_start;
      g += weight * row.by_start.transpose() * row.value;
    }
    const Vector3d down = x.segment<3>(6).normalized();
    constexpr double kInformation = 1.0 / (kGravitySigma * kGravitySigma);
    H.block<3, 3>(6, 6) += kInformation * down * down.transpose();
    g.segment<3>(6) += kInformation * kGravity * down;
    H.block<3, 3>(9, 9).diagonal().array() +=
        1.0 / (kAccelBiasSigma * kAccelBiasSigma);
    const Eigen::LDLT<StartMatrix> solver(H);
    if (solver.info() != Eigen::Success) return std::nullopt;
    x = solver.solve(g);
    covariance = solver.solve(StartMatrix::Identity());
    double sum = 0.0;
    for (const Row& row : rows) {
      sum += (row.value - row.by_start * x).squaredNorm();
    }
    sigma = kAlike *
            std::max(kLeastSigma, std::sqrt(sum / (3.0 * rows.size() - 9.0)));
  }
  Eigen::Matrix<double, 9, 12> end = Eigen::Matrix<double, 9, 12>::Zero();
  end.block<3, 3>(0, 3).setIdentity();
  end.block<3, 3>(0, 6) = sums.seconds * Matrix3d::Identity();
  end.block<3, 3>(0, 9) = sums.v_by_bias;
  end.block<6, 6>(3, 6).setIdentity();
  Solution solution;
  solution.x = end * x;
  solution.x.head<3>() += sums.v;
  solution.covariance = end * covariance * end.transpose();
  return solution;
}

std::optional<PreintegratedMotion> DeadReckoning::StepTo(const CameraImu& imu,
                                                         double stamp) const {
  if (!solution_.has_value() || stamp - path_.back().stamp > kMaxBlind) {
    return std::nullopt;
  }
  return imu.Motion(path_.back().stamp, stamp);
}

std::optional<DeadReckoning::Velocity> DeadReckoning::VelocityAt(
    const CameraImu& imu, double stamp, const Vector3d& angular) const {
  const std::optional<PreintegratedMotion> step = StepTo(imu, stamp);
  if (!step.has_value()) return std::nullopt;
  const std::optional<CameraTurn> turn = imu.Turn(path_.back().stamp, stamp);
  if (!turn.has_value()) return std::nullopt;
  const Matrix3d world_from_last =
      path_.back().world_from_cam.rotation.toRotationMatrix();
  const Matrix3d now_from_last =
      step->start_from_end.conjugate().toRotationMatrix();
  // The velocity of the sensor in the axes of the last pose, by [v g b].
  Eigen::Matrix<double, 3, 9> by_x;
  by_x << world_from_last.transpose(),
      step->seconds * world_from_last.transpose(),
      step->by_bias.block<3, 3>(3, 3);
  const Vector3d sensor = by_x * solution_->x + step->v;
  const Matrix3d covariance = by_x * solution_->covariance * by_x.transpose() +
                              step->covariance.block<3, 3>(3, 3) +
                              std::pow(0.5, 2) * CovarianceAcross(*step, *turn);
  return Velocity{now_from_last * sensor - angular.cross(imu.position()),
                  now_from_last * covariance * now_from_last.transpose()};
}

std::optional<DeadReckoning::Motion> DeadReckoning::Predict(
    const CameraImu& imu, double stamp) const {
  const std::optional<PreintegratedMotion> step = StepTo(imu, stamp);
  if (!step.has_value()) return std::nullopt;
  const Pose& last = path_.back();
  const std::optional<CameraTurn> turn = imu.Turn(last.stamp, stamp);
  if (!turn.has_value()) return std::nullopt;
  const double t = step->seconds;
  const Matrix3d last_from_world =
      last.world_from_cam.rotation.conjugate().toRotationMatrix();
  // The new centre in the axes of the last pose, by [v g b].
  Eigen::Matrix<double, 3, 9> by_x;
  by_x << t * last_from_world, 0.5 * t * t * last_from_world,
      step->by_bias.block<3, 3>(6, 3);
  const Vector3d arm = imu.position();
  const Vector3d center =
      by_x * solution_->x + step->p + arm - step->start_from_end * arm;
  Motion motion;
  motion.cur_from_last = Rigid3d(step->start_from_end, center).Inverse();
  motion.covariance.topLeftCorner<3, 3>() = turn->covariance;
  motion.covariance.bottomRightCorner<3, 3>() =
      by_x * solution_->covariance * by_x.transpose() +
      step->covariance.block<3, 3>(6, 6) +
      std::pow(t / 6.0, 2) * CovarianceAcross(*step, *turn);
  return motion;
}

}  // namespace rgbd_pose
