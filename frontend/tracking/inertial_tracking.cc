#include "frontend/tracking/inertial_tracking.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rgbd_pose {
namespace {

// Turns are learnt over intervals of this length, s: an error of the images
// hides a bias less the longer it takes, but a path drifts.
constexpr double kLearningInterval = 0.2;

// Over longer intervals nothing is learnt, and samples are not kept for longer
// while no frame is found, s.
constexpr double kLongestInterval = 5.0;

// Turns that images show are not known better than this, rad.
constexpr double kLeastTurnSigma = 3e-4;

// The velocity of a frame that was exposed at one moment is the mean over this,
// s.
constexpr double kShortestExposure = 0.01;

// When the rows of an image are exposed, s after the stamp.
struct Exposure {
  double from = 0.0;
  double to = 0.0;
};

Exposure ExposureOf(const Shutter& shutter) {
  const double half =
      0.5 * std::max(kShortestExposure, std::abs(shutter.readout));
  return {shutter.offset - half, shutter.offset + half};
}

// Accelerations are not used before the delay of the sensor is known to this,
// s: a pan begins within a tenth of a second.
constexpr double kMaxDelaySigma = 0.005;

// Where a camera is turned fast, the errors of its last poses are more alike
// than the covariance of the velocity allows for: sigma is so much larger.
constexpr double kPathErrsAlike = 3.0;

// Exposures are divided into so many parts, to find how velocities change.
constexpr int kParts = 4;

// A velocity that changes at a constant rate.
struct Line {
  Eigen::Vector3d value;  // at the stamp
  Eigen::Vector3d slope;  // per second

  // How far the motion is from that at this velocity: the root of the mean
  // square of the distances at the ends of the parts.
  double rest = 0.0;
};

// Fits a line to the mean velocities of parts by least squares. Each part lasts
// `part` seconds, and the first begins `from` seconds after the stamp.
Line FitLine(const std::array<Eigen::Vector3d, kParts>& values, double from,
             double part) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double squares = 0.0;
  const auto after_middle = [&](int i) {
    return part * (i + 0.5 - 0.5 * kParts);
  };
  for (int i = 0; i < kParts; ++i) {
    mean += values[i] / kParts;
    moment += after_middle(i) * values[i];
    squares += after_middle(i) * after_middle(i);
  }
  Line line;
  line.slope = moment / squares;
  const double middle = from + 0.5 * kParts * part;
  line.value = mean - middle * line.slope;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < kParts; ++i) {
    sum += part * (values[i] - mean - after_middle(i) * line.slope);
    line.rest += sum.squaredNorm() / kParts;
  }
  line.rest = std::sqrt(line.rest);
  return line;
}

}  // namespace

std::optional<CameraTurn> InertialTracking::Turn(double from, double to) const {
  if (!imu_.is_trusted()) return std::nullopt;
  return imu_.Turn(from, to);
}

std::optional<MeasuredTwist> InertialTracking::TwistDuring(
    const Frame& frame) const {
  if (!imu_.is_trusted()) return std::nullopt;
  const Exposure color = ExposureOf(frame.color_shutter);
  const std::optional<CameraRate> mean =
      imu_.Rate(frame.timestamp + color.from, frame.timestamp + color.to);
  if (!mean.has_value()) return std::nullopt;
  MeasuredTwist measured;
  measured.twist.angular = mean->angular;
  measured.sigma_angular = std::sqrt(mean->covariance.trace() / 3.0);
  if (imu_.delay_sigma() > kMaxDelaySigma) return measured;
  const Exposure depth = ExposureOf(frame.DepthShutter());
  const double from = std::min(color.from, depth.from);
  const double part = (std::max(color.to, depth.to) - from) / kParts;
  std::array<Eigen::Vector3d, kParts> rates, velocities;
  for (int i = 0; i < kParts; ++i) {
    const double start = frame.timestamp + from + i * part;
    const std::optional<CameraRate> rate = imu_.Rate(start, start + part);
    if (!rate.has_value()) return measured;
    rates[i] = rate->angular;
  }
  const Line rate = FitLine(rates, from, part);
  measured.twist.angular = rate.value;
  measured.twist.angular_acceleration = rate.slope;
  measured.rest_turn = rate.rest;
  double variance = 0.0;
  for (int i = 0; i < kParts; ++i) {
    const double middle = frame.timestamp + from + (i + 0.5) * part;
    const std::optional<DeadReckoning::Velocity> velocity =
        path_.VelocityAt(imu_, middle, rates[i]);
    if (!velocity.has_value()) return measured;
    velocities[i] = velocity->linear;
    variance = velocity->covariance.trace() / 3.0;  // largest at the end
  }
  const Line velocity = FitLine(velocities, from, part);
  measured.twist.linear = velocity.value;
  measured.twist.linear_acceleration = velocity.slope;
  measured.sigma_linear = kPathErrsAlike * std::sqrt(variance);
  measured.rest_shift = velocity.rest;
  return measured;
}

std::optional<DeadReckoning::Motion> InertialTracking::Since(
    double stamp) const {
  if (!imu_.is_trusted()) return std::nullopt;
  return path_.Predict(imu_, stamp);
}

void InertialTracking::Learn(const TrackedFrame& frame) {
  if (frame.status != TrackingStatus::kOk) {
    imu_.ForgetBefore(frame.timestamp - kLongestInterval);
    // A turn that the sensor itself has measured teaches nothing about it.
    if (frame.source == TrackingSource::kInertial) start_.reset();
    return;
  }
  if (frame.segment != segment_ || frame.relocalised) {
    path_.Clear();
    start_.reset();
  }
  segment_ = frame.segment;
  path_.Add(imu_, frame.timestamp, frame.world_from_cam);
  Start now = {frame.timestamp, frame.world_from_cam.rotation,
               kLeastTurnSigma * kLeastTurnSigma * Eigen::Matrix3d::Identity()};
  if (!frame.edges.empty()) {
    now.covariance += frame.edges.front().covariance.topLeftCorner<3, 3>();
  }
  if (!start_.has_value() || now.stamp - start_->stamp > kLongestInterval) {
    start_ = now;
  } else if (now.stamp - start_->stamp >= kLearningInterval) {
    const Eigen::Quaterniond now_from_start =
        now.world_from_cam.conjugate() * start_->world_from_cam;
    const Eigen::Matrix3d turn = now_from_start.toRotationMatrix();
    imu_.Learn(start_->stamp, now.stamp,
               {now_from_start,
                now.covariance + turn * start_->covariance * turn.transpose()});
    start_ = now;
  }
  imu_.ForgetBefore(path_.needed_from().value());
}

}  // namespace rgbd_pose
