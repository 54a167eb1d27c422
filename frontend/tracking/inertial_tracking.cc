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

// The rate of a frame that was exposed at one moment is the mean over this, s.
constexpr double kShortestExposure = 0.01;

}  // namespace

std::optional<CameraTurn> InertialTracking::Turn(double from, double to) const {
  if (!imu_.is_trusted()) return std::nullopt;
  return imu_.Turn(from, to);
}

std::optional<CameraRate> InertialTracking::RateDuring(
    const Frame& frame) const {
  if (!imu_.is_trusted()) return std::nullopt;
  const double middle = frame.timestamp + frame.color_shutter.offset;
  const double half =
      0.5 * std::max(kShortestExposure, std::abs(frame.color_shutter.readout));
  return imu_.Rate(middle - half, middle + half);
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
  path_.Add(frame.timestamp, frame.world_from_cam);
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
