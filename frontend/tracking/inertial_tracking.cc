#include "frontend/tracking/inertial_tracking.h"

#include <algorithm>
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

}  // namespace

std::optional<CameraTurn> InertialTracking::Turn(double from, double to) const {
  if (!imu_.is_trusted()) return std::nullopt;
  return imu_.Turn(from, to);
}

std::optional<MeasuredTwist> InertialTracking::TwistDuring(
    const Frame& frame) const {
  if (!imu_.is_trusted()) return std::nullopt;
  const Exposure color = ExposureOf(frame.color_shutter);
  const std::optional<CameraRate> rate =
      imu_.Rate(frame.timestamp + color.from, frame.timestamp + color.to);
  if (!rate.has_value()) return std::nullopt;
  MeasuredTwist measured;
  Twist& twist = measured.twist;
  twist.angular_acceleration = rate->acceleration;
  twist.angular =
      rate->angular - frame.color_shutter.offset * twist.angular_acceleration;
  measured.sigma_angular = std::sqrt(rate->covariance.trace() / 3.0);
  // Surfaces move along their viewing rays until depth is exposed.
  const Exposure depth = ExposureOf(frame.DepthShutter());
  const double from = std::min(color.from, depth.from);
  const double to = std::max(color.to, depth.to);
  const auto velocity_at = [&](double after) {
    return path_.VelocityAt(imu_, frame.timestamp + after,
                            twist.After(after).angular);
  };
  const std::optional<DeadReckoning::Velocity> first = velocity_at(from);
  const std::optional<DeadReckoning::Velocity> last = velocity_at(to);
  if (!first.has_value() || !last.has_value()) return measured;
  twist.linear_acceleration = (last->linear - first->linear) / (to - from);
  twist.linear = first->linear - from * twist.linear_acceleration;
  measured.sigma_linear = std::sqrt(last->covariance.trace() / 3.0);
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
