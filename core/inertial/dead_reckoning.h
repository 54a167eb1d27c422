#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/inertial/camera_imu.h"

namespace rgbd_pose {

// How a camera has moved since the last pose that images have shown, by its
// inertial sensor: from the last two seconds of the path and the samples since.
//
// With the turns of the camera known, its positions are linear in what is not:
//
//   p(t) = p(0) + v(0) t + g t^2 / 2 + (twice integrated samples)(t) - B(t) b
//
// Position and velocity at the start, gravity g and the accelerometer's bias b
// are found by least squares after each pose.
class DeadReckoning {
 public:
  // Nothing is predicted further than this after the last pose, s.
  static constexpr double kMaxBlind = 2.0;

  // Adds a pose that images have shown. All are in one world. Samples since the
  // pose before are integrated with what is known of the sensor by now.
  void Add(const CameraImu& imu, double stamp, const Rigid3d& world_from_cam);

  // Forgets the path: the next pose is in another world.
  void Clear() { *this = DeadReckoning(); }

  // The stamp from which on samples are needed, s; nothing without a path.
  std::optional<double> needed_from() const;

  // A motion since the last pose.
  struct Motion {
    Rigid3d cur_from_last;                           // as predicted
    MotionMatrix covariance = MotionMatrix::Zero();  // as in MotionEstimate
  };

  // The motion from the last pose to a later time. Nothing if the path is too
  // short or too old, or if samples are missing.
  std::optional<Motion> Predict(const CameraImu& imu, double stamp) const;

  // How the camera moves along a line, in its own axes.
  struct Velocity {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero();      // m/s
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of `linear`
  };

  // The velocity at a time since the last pose, while the camera turns with
  // this rate. Nothing as above.
  std::optional<Velocity> VelocityAt(const CameraImu& imu, double stamp,
                                     const Eigen::Vector3d& angular) const;

 private:
  // The unknowns: [v at the last pose, g, b].
  using Unknowns = Eigen::Matrix<double, 9, 1>;
  struct Solution {
    Unknowns x;
    Eigen::Matrix<double, 9, 9> covariance;
  };
  std::optional<Solution> Solve(const Eigen::Vector3d& arm) const;

  // The samples between the last pose and a later time; nothing if they are
  // missing, or if it is too late.
  std::optional<PreintegratedMotion> StepTo(const CameraImu& imu,
                                            double stamp) const;

  struct Pose {
    double stamp = 0.0;
    Rigid3d world_from_cam;
    std::optional<PreintegratedMotion> step;  // to it from the pose before
  };
  std::deque<Pose> path_;
  std::optional<Solution> solution_;
};

}  // namespace rgbd_pose
