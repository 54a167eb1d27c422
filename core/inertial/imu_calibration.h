#pragma once

#include <optional>

#include "core/geometry/rigid3.h"
#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// What is known of an inertial sensor beside a camera. It is often put together
// from several files, so each part may be missing.
struct ImuCalibration {
  // The mounting: the axes of the samples in those of the colour camera.
  std::optional<Rigid3d> cam_from_imu;

  // How much later than the camera's clock the sensor's clock says, s: a sample
  // with the stamp t is from t - delay_s of the camera's clock. Kalibr's
  // timeshift_cam_imu.
  std::optional<double> delay_s;

  std::optional<ImuNoise> noise;  // of its samples

  // Whether nothing is known.
  bool IsEmpty() const { return !cam_from_imu && !delay_s && !noise; }

  // Takes what is missing here from another calibration.
  void CompleteFrom(const ImuCalibration& other) {
    if (!cam_from_imu) cam_from_imu = other.cam_from_imu;
    if (!delay_s) delay_s = other.delay_s;
    if (!noise) noise = other.noise;
  }
};

// The inertial sensor of a recording.
struct ImuSensor {
  ImuCalibration calibration;  // as far as it is known
  bool has_gyro = true;  // if not, the angular velocities of samples are 0
};

}  // namespace rgbd_pose
