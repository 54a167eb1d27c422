#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/inertial/camera_imu.h"

namespace rgbd_pose {

// Goes on with a camera's path where images show nothing, by its inertial
// sensor: from the last two seconds of the path and the samples since.
//
// With the turns of the camera known, its positions are linear in what is not:
//
//   p(t) = p(0) + v(0) t + g t^2 / 2 + (twice integrated samples)(t) - B(t) b
//
// Position and velocity at the start, gravity g and the accelerometer's bias b
// are found by least squares each time that they are asked for, so that this
// costs nothing as long as images show the way.
class DeadReckoning {
 public:
  // Nothing is predicted further than this after the last pose, s.
  static constexpr double kMaxBlind = 2.0;

  // Adds a pose that images have shown. All are in one world.
  void Add(double stamp, const Rigid3d& world_from_cam);

  // Forgets the path: the next pose is in another world.
  void Clear() { path_.clear(); }

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

 private:
  struct Pose {
    double stamp = 0.0;
    Rigid3d world_from_cam;
  };

  // The unknowns: [v at the last pose, g, b].
  using Unknowns = Eigen::Matrix<double, 9, 1>;
  struct Solution {
    Unknowns x;
    Eigen::Matrix<double, 9, 9> covariance;
  };
  std::optional<Solution> Solve(const CameraImu& imu) const;

  std::deque<Pose> path_;
};

}  // namespace rgbd_pose
