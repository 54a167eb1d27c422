#include "core/inertial/camera_imu.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/geometry/rigid3.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// Errors of a turn as a share of it: scale factors, axes that are not square.
constexpr double kShareOfTurn = 0.005;

// The mean chi^2 follows about the last ten turns. Of a single turn with more
// than the limit nothing is learnt, as the images may have erred.
constexpr double kShareOfNew = 0.1;
constexpr double kMostOfOne = 30.0;

// An axis that has the same value this often in a row, rad/s or more, has
// reached the end of its range.
constexpr size_t kSameInARow = 3;
constexpr double kFastRate = 1.0;

// Errors of a calibration, rad and s, that are clear if they are larger and
// have so many standard deviations. The axes of a gyroscope may differ from
// those of the accelerometer by 2 %.
constexpr double kUsualTurn = 0.02;
constexpr double kUsualDelay = 0.005;
constexpr double kClearSigmas = 4.0;

// The samples as they were measured from which a covered interval is
// interpolated, and one more on either side unless there is a gap.
std::vector<ImuSample> SamplesAround(const ImuBuffer& buffer, double from,
                                     double to) {
  const std::vector<ImuSample>& all = buffer.samples();
  auto first = std::upper_bound(all.begin(), all.end(), from,
                                [](double time, const ImuSample& sample) {
                                  return time < sample.stamp;
                                }) -
               1;
  auto last = std::lower_bound(
      first, all.end(), to,
      [](const ImuSample& sample, double time) { return sample.stamp < time; });
  const auto are_near = [](const ImuSample& a, const ImuSample& b) {
    return b.stamp - a.stamp <= ImuBuffer::kMaxGap;
  };
  if (first != all.begin() && are_near(first[-1], *first)) --first;
  if (last + 1 != all.end() && are_near(*last, last[1])) ++last;
  return {first, last + 1};
}

bool IsSaturated(const std::vector<ImuSample>& samples) {
  for (int axis = 0; axis < 3; ++axis) {
    size_t same = 1;
    for (size_t i = 1; i < samples.size(); ++i) {
      const double rate = samples[i].gyro[axis];
      same = rate == samples[i - 1].gyro[axis] ? same + 1 : 1;
      if (same >= kSameInARow && std::abs(rate) >= kFastRate) return true;
    }
  }
  return false;
}

// A single sample that is farther than this from the line between both of its
// neighbours is a fault of the sensor or its cable, rad/s: a shaking of 10
// rad/s at 5 Hz is bent by 2 rad/s even at 50 samples a second.
constexpr double kSpike = 3.0;

bool HasSpike(const std::vector<ImuSample>& samples) {
  for (size_t i = 1; i + 1 < samples.size(); ++i) {
    const ImuSample& before = samples[i - 1];
    const ImuSample& after = samples[i + 1];
    const double part =
        (samples[i].stamp - before.stamp) / (after.stamp - before.stamp);
    const Eigen::Vector3d between =
        before.gyro + part * (after.gyro - before.gyro);
    if ((samples[i].gyro - between).norm() > kSpike) return true;
  }
  return false;
}

// Whether a sample adds nothing to those before: a gyroscope that hangs repeats
// its last value. So does an accelerometer, but for longer, as drivers copy the
// values of a slow one to all samples of a fast gyroscope. Without one, zeros
// stand for its values.
bool IsRepeated(const ImuSample& sample, const std::vector<ImuSample>& before) {
  if (before.empty()) return false;
  if (sample.gyro == before.back().gyro) return true;
  if (sample.accel.isZero(0.0)) return false;
  for (auto earlier = before.rbegin();
       earlier != before.rend() && earlier->accel == sample.accel; ++earlier) {
    if (sample.stamp - earlier->stamp > ImuBuffer::kMaxGap) return true;
  }
  return false;
}

}  // namespace

CameraImu::CameraImu(const ImuSensor& sensor)
    : noise_(sensor.calibration.noise.value_or(ImuNoise())),
      cam_from_imu_(sensor.calibration.cam_from_imu.value()),
      delay_s_(sensor.calibration.delay_s.value_or(0.0)) {
  RequireSound(noise_.Check(), "inertial sensor: ");
  if (!std::isfinite(delay_s_)) {
    throw InputError("inertial sensor: its delay must be a number of seconds");
  }
  if (!cam_from_imu_.IsFinite()) {
    throw InputError("inertial sensor: its mounting must be finite");
  }
  State sigmas;
  const bool has_delay = sensor.calibration.delay_s.has_value();
  sigmas << Eigen::Vector3d::Constant(kBiasSigma),
      has_delay ? kDelaySigma : kUnknownDelaySigma,
      Eigen::Vector3d::Constant(kMountingSigma);
  covariance_ = sigmas.cwiseAbs2().asDiagonal();
}

void CameraImu::Add(const std::vector<ImuSample>& samples) {
  for (const ImuSample& sample : samples) {
    if (!std::isfinite(sample.stamp) || !sample.gyro.allFinite() ||
        !sample.accel.allFinite()) {
      continue;
    }
    const std::vector<ImuSample>& before = buffer_.samples();
    if (!before.empty() && !(sample.stamp > before.back().stamp)) continue;
    if (IsRepeated(sample, before)) {
      repeated_until_ = sample.stamp;
    } else {
      buffer_.Add(sample);
    }
  }
}

bool CameraImu::is_frozen() const {
  return repeated_until_.has_value() &&
         *repeated_until_ - buffer_.samples().back().stamp > ImuBuffer::kMaxGap;
}

void CameraImu::ForgetBefore(double stamp) {
  constexpr double kMargin = 10.0 * kUnknownDelaySigma;
  buffer_.ForgetBefore(stamp + delay() - kMargin);
}

Eigen::Quaterniond CameraImu::cam_from_imu_turn() const {
  return Rigid3d::FromRotationVector(state_.tail<3>(), Eigen::Vector3d::Zero())
             .rotation *
         cam_from_imu_.rotation;
}

std::optional<PreintegratedMotion> CameraImu::Motion(double from,
                                                     double to) const {
  if (!(from < to)) return std::nullopt;
  if (!buffer_.Covers(from + delay(), to + delay())) return std::nullopt;
  // Interpolated samples would hide faults next to the ends.
  const std::vector<ImuSample> measured =
      SamplesAround(buffer_, from + delay(), to + delay());
  if (IsSaturated(measured) || HasSpike(measured)) return std::nullopt;
  ImuBiasVector bias = ImuBiasVector::Zero();
  bias.head<3>() = state_.head<3>();
  PreintegratedMotion motion =
      Preintegrate(buffer_.Between(from + delay(), to + delay()), bias, noise_);
  const Eigen::Quaterniond turn = cam_from_imu_turn();
  const Eigen::Matrix3d R = turn.toRotationMatrix();
  motion.start_from_end = turn * motion.start_from_end * turn.conjugate();
  motion.v = R * motion.v;
  motion.p = R * motion.p;
  Eigen::Matrix<double, 9, 9> turned = Eigen::Matrix<double, 9, 9>::Zero();
  for (int i = 0; i < 9; i += 3) turned.block<3, 3>(i, i) = R;
  motion.by_bias = turned * motion.by_bias;
  PreintegratedMotion::Covariance& covariance = motion.covariance;
  covariance.topLeftCorner<9, 9>() =
      turned * covariance.topLeftCorner<9, 9>() * turned.transpose();
  covariance.topRightCorner<9, 6>() =
      (turned * covariance.topRightCorner<9, 6>()).eval();
  covariance.bottomLeftCorner<6, 9>() =
      covariance.topRightCorner<9, 6>().transpose();
  return motion;
}

CameraImu::ByState CameraImu::StateDerivative(
    double from, double to, const PreintegratedMotion& motion) const {
  const std::vector<ImuSample> samples =
      buffer_.Between(from + delay(), to + delay());
  const Eigen::Matrix3d R = cam_from_imu_turn().toRotationMatrix();
  const Eigen::Vector3d bias = state_.head<3>();
  const Eigen::Matrix3d end_from_start =
      motion.start_from_end.conjugate().toRotationMatrix();
  ByState by_state;
  by_state.leftCols<3>() = motion.by_bias.topLeftCorner<3, 3>();
  by_state.col(3) = R * (samples.back().gyro - bias) -
                    end_from_start * R * (samples.front().gyro - bias);
  by_state.rightCols<3>() = end_from_start - Eigen::Matrix3d::Identity();
  return by_state;
}

CameraTurn CameraImu::TurnOf(const PreintegratedMotion& motion,
                             const ByState& by_state) const {
  const double share =
      kShareOfTurn * RotationVector(motion.start_from_end).norm();
  return {motion.start_from_end.conjugate(),
          motion.covariance.topLeftCorner<3, 3>() +
              by_state * covariance_ * by_state.transpose() +
              share * share * Eigen::Matrix3d::Identity()};
}

std::optional<CameraTurn> CameraImu::Turn(double from, double to) const {
  const std::optional<PreintegratedMotion> motion = Motion(from, to);
  if (!motion.has_value()) return std::nullopt;
  const Eigen::Vector3d angles = RotationVector(motion->start_from_end);
  CameraTurn turn = TurnOf(*motion, StateDerivative(from, to, *motion));
  turn.covariance.diagonal().array() += angles.dot(untested_ * angles);
  return turn;
}

std::optional<CameraRate> CameraImu::Rate(double from, double to) const {
  const std::optional<CameraTurn> turn = Turn(from, to);
  if (!turn.has_value()) return std::nullopt;
  const double per_second = 1.0 / (to - from);
  return CameraRate{-per_second * RotationVector(turn->cur_from_prev),
                    per_second * per_second * turn->covariance};
}

void CameraImu::Learn(double from, double to, const CameraTurn& seen) {
  const std::optional<PreintegratedMotion> motion = Motion(from, to);
  if (!motion.has_value()) return;
  const ByState by_state = StateDerivative(from, to, *motion);
  const CameraTurn turn = TurnOf(*motion, by_state);
  // Turns of the start's axes to those of the end have the opposite sign.
  const Eigen::Vector3d off =
      -RotationVector(seen.cur_from_prev * turn.cur_from_prev.conjugate());
  const Eigen::Matrix3d expected = turn.covariance + seen.covariance;
  const Eigen::LLT<Eigen::Matrix3d> solver(expected);
  if (solver.info() != Eigen::Success) return;
  const double chi2 = off.dot(solver.solve(off)) / 3.0;
  contradiction_ += kShareOfNew * (std::min(chi2, kMostOfOne) - contradiction_);
  ++learnt_;
  if (chi2 > kMostOfOne) return;
  const Eigen::Vector3d angles = RotationVector(motion->start_from_end);
  const Eigen::Vector3d shown = untested_ * angles;
  untested_ -=
      (shown * shown.transpose() / (angles.dot(shown) + expected.trace() / 3.0))
          .eval();
  // A bias walks from one turn that is learnt to the next.
  if (learnt_until_.has_value()) {
    covariance_.topLeftCorner<3, 3>().diagonal().array() +=
        noise_.gyro_walk * noise_.gyro_walk * (to - *learnt_until_);
  }
  learnt_until_ = to;
  const Eigen::Matrix<double, 7, 3> gain =
      solver.solve(by_state * covariance_).transpose();
  state_ += gain * off;
  covariance_ -= (gain * by_state * covariance_).eval();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
}

std::string CameraImu::doubt() const {
  if (contradiction_ > kMostContradiction) {
    return Format(
        "it contradicts the images: its turns are off by %.1f standard "
        "deviations; check its mounting, delay and axes",
        std::sqrt(contradiction_));
  }
  if (is_frozen()) {
    return Format("it has repeated the same sample for %.2g s: it is frozen",
                  *repeated_until_ - buffer_.samples().back().stamp);
  }
  if (learnt_ >= kMinLearnt) return "";
  const std::vector<ImuSample>& samples = buffer_.samples();
  if (samples.size() < 2) {
    return "there are no samples at the time of the frames; do both use the "
           "same clock?";
  }
  const double interval = (samples.back().stamp - samples.front().stamp) /
                          static_cast<double>(samples.size() - 1);
  if (interval > ImuBuffer::kMaxGap) {
    return Format("it has %.3g samples per second; more than %.3g are needed",
                  1.0 / interval, 1.0 / ImuBuffer::kMaxGap);
  }
  return "images have shown too few turns";
}

ImuCalibration CameraImu::Calibration() const {
  return {Rigid3d(cam_from_imu_turn(), position()), delay(), noise_};
}

std::optional<ImuCalibration> CameraImu::Correction() const {
  const Eigen::Vector3d turned = state_.tail<3>();
  const double in_sigmas =
      turned.dot(covariance_.bottomRightCorner<3, 3>().ldlt().solve(turned));
  const bool is_turned =
      turned.norm() > kUsualTurn && in_sigmas > kClearSigmas * kClearSigmas;
  const bool is_late =
      std::abs(state_[3]) > std::max(kUsualDelay, kClearSigmas * delay_sigma());
  if (!is_trusted() || !(is_turned || is_late)) return std::nullopt;
  return Calibration();
}

}  // namespace rgbd_pose
