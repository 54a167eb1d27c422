#include "core/inertial/imu_merger.h"

#include "core/inertial/imu_buffer.h"

namespace rgbd_pose {

void ImuMerger::AddGyro(double stamp, const Eigen::Vector3d& gyro) {
  gyro_.Add(stamp, gyro);
}

void ImuMerger::AddAccel(double stamp, const Eigen::Vector3d& accel) {
  accel_.Add(stamp, accel);
}

void ImuMerger::Stream::Add(double stamp, const Eigen::Vector3d& value) {
  if (!(stamp > last_stamp)) return;
  last_stamp = stamp;
  values.push_back({stamp, value});
}

std::vector<ImuSample> ImuMerger::Take() {
  std::vector<ImuSample> samples;
  while (!gyro_.values.empty() && accel_.values.size() > 1) {
    const Value& a = accel_.values[0];
    const Value& b = accel_.values[1];
    const Value& gyro = gyro_.values.front();
    if (gyro.stamp >= b.stamp) {
      accel_.values.pop_front();
      continue;
    }
    const double gap = b.stamp - a.stamp;
    const bool is_between = gyro.stamp > a.stamp && gap <= ImuBuffer::kMaxGap;
    if (gyro.stamp == a.stamp || is_between) {
      const double part = (gyro.stamp - a.stamp) / gap;
      samples.push_back(
          {gyro.stamp, gyro.value, a.value + part * (b.value - a.value)});
    }
    gyro_.values.pop_front();
  }
  return samples;
}

}  // namespace rgbd_pose
