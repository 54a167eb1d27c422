#include "core/inertial/preintegration.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/geometry/rigid3.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// J with Exp(omega + d) = Exp(omega) Exp(J d) to first order (Forster et al.,
// equation 8).
Matrix3d RightJacobian(const Vector3d& omega) {
  const double squared = omega.squaredNorm();
  // The factors of [omega] and of its square, at small angles by their series.
  double a = 0.5 - squared / 24.0, b = 1.0 / 6.0 - squared / 120.0;
  if (squared > 1e-4) {
    const double angle = std::sqrt(squared);
    a = (1.0 - std::cos(angle)) / squared;
    b = (angle - std::sin(angle)) / (squared * angle);
  }
  const Matrix3d cross = CrossMatrix(omega);
  return Matrix3d::Identity() - a * cross + b * cross * cross;
}

// Continues a motion from one sample to the next.
class Integrator {
 public:
  Integrator(const ImuNoise& noise, PreintegratedMotion* motion)
      : noise_(noise), motion_(motion) {}

  void Step(const ImuSample& from, const ImuSample& to) {
    const double dt = to.stamp - from.stamp;
    const Vector3d gyro_bias = motion_->bias.head<3>();
    const Vector3d accel_bias = motion_->bias.tail<3>();
    const Vector3d w0 = from.gyro - gyro_bias, w1 = to.gyro - gyro_bias;
    const Vector3d a0 = from.accel - accel_bias, a1 = to.accel - accel_bias;
    // The rotation by a rate that is linear in time: the second term (coning)
    // is that of Magnus' series.
    const Vector3d turn =
        0.5 * dt * (w0 + w1) + (dt * dt / 12.0) * w0.cross(w1);
    const Eigen::Quaterniond end_from_next =
        Rigid3d::FromRotationVector(turn, Vector3d::Zero()).rotation;
    const Matrix3d R0 = motion_->start_from_end.toRotationMatrix();
    motion_->start_from_end =
        (motion_->start_from_end * end_from_next).normalized();
    const Matrix3d R1 = motion_->start_from_end.toRotationMatrix();
    // The acceleration along the axes of the start is linear in time, too.
    const Vector3d A0 = R0 * a0, A1 = R1 * a1;
    motion_->p += dt * motion_->v + dt * dt * (A0 / 3.0 + A1 / 6.0);
    motion_->v += 0.5 * dt * (A0 + A1);
    motion_->seconds += dt;

    // Changes of [omega v p gyro accel] by those before; a bias is taken off
    // both samples.
    PreintegratedMotion::Covariance F =
        PreintegratedMotion::Covariance::Identity();
    const Matrix3d turn_by_gyro =
        -dt * Matrix3d::Identity() +
        (dt * dt / 12.0) * (CrossMatrix(w1) - CrossMatrix(w0));
    const Matrix3d omega_by_omega =
        end_from_next.toRotationMatrix().transpose();
    const Matrix3d omega_by_gyro = RightJacobian(turn) * turn_by_gyro;
    const Matrix3d A0_by_omega = -R0 * CrossMatrix(a0);
    const Matrix3d A1_by_next_omega = -R1 * CrossMatrix(a1);
    const Matrix3d A1_by_omega = A1_by_next_omega * omega_by_omega;
    const Matrix3d A1_by_gyro = A1_by_next_omega * omega_by_gyro;
    F.block<3, 3>(kOmega, kOmega) = omega_by_omega;
    F.block<3, 3>(kOmega, kGyro) = omega_by_gyro;
    F.block<3, 3>(kV, kOmega) = 0.5 * dt * (A0_by_omega + A1_by_omega);
    F.block<3, 3>(kV, kGyro) = 0.5 * dt * A1_by_gyro;
    F.block<3, 3>(kV, kAccel) = -0.5 * dt * (R0 + R1);
    F.block<3, 3>(kP, kOmega) =
        dt * dt * (A0_by_omega / 3.0 + A1_by_omega / 6.0);
    F.block<3, 3>(kP, kV) = dt * Matrix3d::Identity();
    F.block<3, 3>(kP, kGyro) = (dt * dt / 6.0) * A1_by_gyro;
    F.block<3, 3>(kP, kAccel) = -dt * dt * (R0 / 3.0 + R1 / 6.0);
    motion_->by_bias =
        (F.topLeftCorner<9, 9>() * motion_->by_bias + F.topRightCorner<9, 6>())
            .eval();
    PreintegratedMotion::Covariance& P = motion_->covariance;
    P = (F * P * F.transpose()).eval();
    AddNoise(dt);
  }

 private:
  // Places in the covariance.
  static constexpr int kOmega = 0, kV = 3, kP = 6, kGyro = 9, kAccel = 12;

  // White noise over dt in continuous time: one step alone determines both v
  // and p, which samples with one error each would not.
  void AddNoise(double dt) {
    PreintegratedMotion::Covariance& P = motion_->covariance;
    const double accel = noise_.accel_density * noise_.accel_density;
    const auto add = [&P](int row, int column, double variance) {
      P.block<3, 3>(row, column).diagonal().array() += variance;
    };
    add(kOmega, kOmega, noise_.gyro_density * noise_.gyro_density * dt);
    add(kV, kV, accel * dt);
    add(kV, kP, accel * dt * dt / 2.0);
    add(kP, kV, accel * dt * dt / 2.0);
    add(kP, kP, accel * dt * dt * dt / 3.0);
    add(kGyro, kGyro, noise_.gyro_walk * noise_.gyro_walk * dt);
    add(kAccel, kAccel, noise_.accel_walk * noise_.accel_walk * dt);
  }

  const ImuNoise noise_;
  PreintegratedMotion* const motion_;
};

}  // namespace

PreintegratedMotion::Covariance PreintegratedMotion::SqrtInformation() const {
  if (!covariance.allFinite()) {
    throw InputError(
        "an inertial interval is not finite: check its samples and its bias");
  }
  // Scaled first: positions and biases differ by orders of magnitude.
  const Eigen::Matrix<double, 15, 1> sigma = covariance.diagonal().cwiseSqrt();
  const Covariance scaled = sigma.cwiseInverse().asDiagonal() * covariance *
                            sigma.cwiseInverse().asDiagonal();
  const Eigen::LLT<Covariance> cholesky(scaled);
  if (!scaled.allFinite() || cholesky.info() != Eigen::Success) {
    throw InputError(
        "the covariance of an inertial interval is not positive definite");
  }
  Covariance S = sigma.cwiseInverse().asDiagonal();
  cholesky.matrixL().solveInPlace(S);
  return S;
}

PreintegratedMotion Preintegrate(const std::vector<ImuSample>& samples,
                                 const ImuBiasVector& bias,
                                 const ImuNoise& noise) {
  RequireSound(noise.Check());
  if (samples.size() < 2) {
    throw InputError(
        "inertial samples at two moments or more make a motion, not " +
        std::to_string(samples.size()));
  }
  PreintegratedMotion motion;
  motion.bias = bias;
  Integrator integrator(noise, &motion);
  for (size_t i = 1; i < samples.size(); ++i) {
    if (!(samples[i].stamp > samples[i - 1].stamp)) {
      throw InputError(Format(
          "stamps of inertial samples must increase: %.6f s follows %.6f s",
          samples[i].stamp, samples[i - 1].stamp));
    }
    integrator.Step(samples[i - 1], samples[i]);
  }
  return motion;
}

}  // namespace rgbd_pose
