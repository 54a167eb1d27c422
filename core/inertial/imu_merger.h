#pragma once

#include <Eigen/Core>
#include <deque>
#include <limits>
#include <vector>

#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// Puts the streams of a gyroscope and of an accelerometer, which are stamped
// separately, together to one: a sample at each stamp of the gyroscope, which
// is the faster one, with the acceleration between those before and after it.
class ImuMerger {
 public:
  // Add the next value of a stream, rad/s or m/s^2. One that is not later than
  // the one before is left out.
  void AddGyro(double stamp, const Eigen::Vector3d& gyro);
  void AddAccel(double stamp, const Eigen::Vector3d& accel);

  // The samples that are known since the last call, in order. None where the
  // accelerometer pauses for more than ImuBuffer::kMaxGap.
  std::vector<ImuSample> Take();

 private:
  struct Value {
    double stamp;
    Eigen::Vector3d value;
  };
  struct Stream {
    std::deque<Value> values;  // that are still needed
    double last_stamp = -std::numeric_limits<double>::infinity();

    void Add(double stamp, const Eigen::Vector3d& value);
  };

  Stream gyro_;
  Stream accel_;
};

}  // namespace rgbd_pose
