#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/inertial/imu_buffer.h"
#include "core/inertial/imu_calibration.h"
#include "core/inertial/imu_sample.h"
#include "core/inertial/preintegration.h"

namespace rgbd_pose {

// A turn of the camera.
struct CameraTurn {
  // Turns the axes before into those after it.
  Eigen::Quaterniond cur_from_prev = Eigen::Quaterniond::Identity();

  // Of omega (rad), a small rotation about the current axes:
  // R_true = Exp(omega) R.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// How fast the camera turns in an interval, in its own axes halfway.
struct CameraRate {
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();     // on average, rad/s
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of `angular`
};

// A gyroscope, with an accelerometer, beside a camera. While the camera is
// tracked, turns that the images show correct what is known of the gyroscope:
// its bias, the delay of its clock and how it is mounted (a Kalman filter over
// these seven numbers). They also show whether the sensor can be believed:
// about an axis about which no turn was seen yet, the covariance of a turn is
// as large as the turn.
class CameraImu {
 public:
  // Standard deviations of what a calibration says, before anything is learnt:
  // the bias of a gyroscope, rad/s; the delay, s, and if no delay is given; the
  // mounting, rad.
  static constexpr double kBiasSigma = 0.02;
  static constexpr double kDelaySigma = 0.01;
  static constexpr double kUnknownDelaySigma = 0.03;
  static constexpr double kMountingSigma = 0.05;

  // The sensor must have a gyroscope whose mounting is known. Throws InputError
  // if its noise, its delay or its mounting cannot be used.
  explicit CameraImu(const ImuSensor& sensor);

  // Whether a sensor can be used: it has a gyroscope, its mounting is known.
  static bool CanUse(const ImuSensor& sensor) {
    return sensor.has_gyro && sensor.calibration.cam_from_imu.has_value();
  }

  // Adds samples with the stamps and axes of the sensor. One that is not finite
  // or not later than the one before is left out, and so is one that repeats
  // the one before: a sensor that hangs leaves a gap.
  void Add(const std::vector<ImuSample>& samples);

  // Forgets what is not needed for motions from a time (s, the camera's clock)
  // on.
  void ForgetBefore(double stamp);

  // The motion between two times of the camera's clock, in the axes of the
  // camera at the position of the sensor, less the bias of the gyroscope; both
  // biases are in the axes of the sensor. Nothing if samples are missing, at
  // the end of the gyroscope's range, or if one of them, or the one beside
  // them, is a spike.
  std::optional<PreintegratedMotion> Motion(double from, double to) const;

  // The turn between two times, and the rate. Nothing where Motion has nothing.
  std::optional<CameraTurn> Turn(double from, double to) const;
  std::optional<CameraRate> Rate(double from, double to) const;

  // Learns from a turn between two times that images have shown.
  void Learn(double from, double to, const CameraTurn& seen);

  // Whether turns that were seen have confirmed the sensor: enough of them, and
  // no contradiction.
  bool is_trusted() const {
    return learnt_ >= kMinLearnt && contradiction_ <= kMostContradiction;
  }
  // Why it is not trusted, or that its last samples are of no use, in a line;
  // empty if all is well.
  std::string doubt() const;

  // The number of turns that were seen.
  int num_learnt() const { return learnt_; }

  // The calibration with what was learnt of delay and mounting.
  ImuCalibration Calibration() const;

  // That calibration if the turns clearly contradict the one given, of which
  // small errors are usual; else nothing.
  std::optional<ImuCalibration> Correction() const;

  // Where the sensor is, in the axes of the camera, m.
  const Eigen::Vector3d& position() const { return cam_from_imu_.translation; }

  // What is known by now: the gyroscope's bias (rad/s), what the delay (s) and
  // the mounting (a rotation vector in the camera's axes, rad) are more than
  // the calibration says.
  using State = Eigen::Matrix<double, 7, 1>;
  using StateMatrix = Eigen::Matrix<double, 7, 7>;
  const State& state() const { return state_; }
  const StateMatrix& covariance() const { return covariance_; }

  // Standard deviation of the delay, s.
  double delay_sigma() const { return std::sqrt(covariance_(3, 3)); }

 private:
  static constexpr int kMinLearnt = 3;
  // The images' covariances are not exact, so that a contradiction has to be
  // clear.
  static constexpr double kMostContradiction = 5.0;

  // The derivatives of a turn, a rotation vector in the axes of its end, by the
  // state.
  using ByState = Eigen::Matrix<double, 3, 7>;
  ByState StateDerivative(double from, double to,
                          const PreintegratedMotion& motion) const;

  // The turn as if all axes had been tested.
  CameraTurn TurnOf(const PreintegratedMotion& motion,
                    const ByState& by_state) const;

  // Whether the sensor has repeated itself for longer than a usual gap.
  bool is_frozen() const;

  Eigen::Quaterniond cam_from_imu_turn() const;
  double delay() const { return delay_s_ + state_[3]; }

  ImuNoise noise_;
  Rigid3d cam_from_imu_;
  double delay_s_;
  ImuBuffer buffer_;
  std::optional<double> repeated_until_;  // the last such sample, s
  State state_ = State::Zero();
  StateMatrix covariance_;
  // What else can be wrong is an unknown 3x3 matrix times the turn: the
  // covariance of each of its rows. It shrinks along the axes of turns that
  // were seen. About an axis that no such turn had, all may be wrong.
  Eigen::Matrix3d untested_ = Eigen::Matrix3d::Identity();
  std::optional<double> learnt_until_;  // s
  int learnt_ = 0;                      // number of turns
  double contradiction_ = 1.0;  // mean chi^2 of a turn per degree of freedom
};

}  // namespace rgbd_pose
