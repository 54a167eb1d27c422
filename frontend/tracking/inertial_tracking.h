#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/inertial/camera_imu.h"
#include "core/inertial/dead_reckoning.h"
#include "frontend/frame/frame.h"
#include "frontend/tracking/tracked_frame.h"
#include "frontend/tracking/velocity_prior.h"

namespace rgbd_pose {

// What an inertial sensor beside the camera adds to tracking: how the camera
// has turned since the last frame, how it moves while the rows of a frame are
// exposed, and where it goes while its images show nothing. All of it comes
// with the covariance of what images have taught about the sensor so far, and
// none of it once they contradict the sensor.
class InertialTracking {
 public:
  // The sensor must satisfy CameraImu::CanUse.
  explicit InertialTracking(const ImuSensor& sensor) : imu_(sensor) {}

  // Adds samples in the order of their stamps, see CameraImu::Add.
  void Add(const std::vector<ImuSample>& samples) { imu_.Add(samples); }

  // The turn between two frames; nothing if it is not known.
  std::optional<CameraTurn> Turn(double from, double to) const;

  // The velocity at the stamp of a frame, and how it changes while its rows are
  // exposed, as above. Its linear part needs the path of some frames before.
  std::optional<MeasuredTwist> TwistDuring(const Frame& frame) const;

  // The motion to a time since the last frame that was found so, as above.
  std::optional<DeadReckoning::Motion> Since(double stamp) const;

  // Learns from a frame if images have found it without doubt.
  void Learn(const TrackedFrame& frame);

  const CameraImu& imu() const { return imu_; }

 private:
  // From where the next turn is learnt.
  struct Start {
    double stamp = 0.0;
    Eigen::Quaterniond world_from_cam;
    Eigen::Matrix3d covariance;  // of omega, in its own axes
  };

  CameraImu imu_;
  DeadReckoning path_;
  std::optional<Start> start_;
  int segment_ = 0;
};

}  // namespace rgbd_pose
