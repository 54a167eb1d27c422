#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/inertial/imu_calibration.h"
#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

class CameraImu;

// What held a camera against gravity about a moment, on average.
struct MeanForce {
  size_t at = 0;           // the pose of the path at the moment
  Rigid3d world_from_cam;  // that pose

  // Minus gravity as the sensor measured it, in the axes of the camera, m/s^2:
  // it points upwards.
  Eigen::Vector3d up_in_cam = Eigen::Vector3d::Zero();
};

// Averages the samples of an accelerometer beside a camera whose path is known.
//
// An accelerometer measures f = R^T (a - g). For a moment t1 and moments t0 and
// t2 about half a second before and after it, with weights that grow linearly
// from t0 to t1 and fall to 0 at t2, the mean of the true acceleration a is a
// difference of three positions p of the sensor, however it moved meanwhile:
//
//   (t2 - t0) / 2 * mean a = (p2 - p1) / (t2 - t1) - (p1 - p0) / (t1 - t0)
//
// So -g is the mean of R f less that.
class ForceMeter {
 public:
  // The usual length of each side, t1 - t0 and t2 - t1, s. An error of 1 mm of
  // the position at t1 turns the result by 0.05 degrees; within a second, a
  // path drifts by less.
  static constexpr double kSide = 0.5;

  // Poses that are further apart (s) do not say how the camera turned between.
  static constexpr double kMaxGap = 0.15;

  // A part of the calibration that is not known counts as zero; without the
  // mounting, nothing is measured.
  explicit ForceMeter(const ImuSensor& sensor) : sensor_(sensor) {}

  // Adds samples, with the stamps and axes of the sensor. One that is not
  // finite or not later than the one before is left out.
  void Add(const std::vector<ImuSample>& samples);

  // Takes delay and mounting from a gyroscope beside it, if turns have shown
  // that those given are wrong. Without one (null) nothing changes.
  void CorrectBy(const CameraImu* imu);

  const ImuSensor& sensor() const { return sensor_; }
  const std::vector<ImuSample>& samples() const { return samples_; }

  // The mean about pose `at` of a path in one world, world_from_cam. Nothing if
  // samples or poses are missing in the half second before or after it.
  std::optional<MeanForce> At(const Trajectory& path, size_t at) const;

  // The means along a path at distances of kSide, so that each sample counts
  // as much as any other.
  std::vector<MeanForce> Along(const Trajectory& path) const;

 private:
  // Adds up R f, in the world, from pose `from` to pose `to` with weights from
  // `first` to `last`. False if samples are missing.
  bool AddUp(const Trajectory& path, size_t from, size_t to, double first,
             double last, Eigen::Vector3d* sum) const;

  ImuSensor sensor_;
  std::vector<ImuSample> samples_;
};

}  // namespace rgbd_pose
