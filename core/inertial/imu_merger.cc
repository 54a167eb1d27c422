#include "core/inertial/imu_merger.h"

#include "core/inertial/imu_buffer.h"

namespace rgbd_pose {

void ImuMerger::AddGyro(double stamp, const Eigen::Vector3d& gyro) {
  Add(&gyro_, stamp, gyro);
}

void ImuMerger::AddAccel(double stamp, const Eigen::Vector3d& accel) {
  Add(&accel_, stamp, accel);
}

void ImuMerger::Add(std::deque<Value>* stream, double stamp,
                    const Eigen::Vector3d& value) {
  if (!stream->empty() && !(stamp > stream->back().stamp)) return;
  stream->push_back({stamp, value});
}

std::vector<ImuSample> ImuMerger::Take() {
  std::vector<ImuSample> samples;
  while (!gyro_.empty() && accel_.size() > 1) {
    const Value& a = accel_[0];
    const Value& b = accel_[1];
    const Value& gyro = gyro_.front();
    if (gyro.stamp >= b.stamp) {
      accel_.pop_front();
      continue;
    }
    const double gap = b.stamp - a.stamp;
    const bool is_between = gyro.stamp > a.stamp && gap <= ImuBuffer::kMaxGap;
    if (gyro.stamp == a.stamp || is_between) {
      const double part = (gyro.stamp - a.stamp) / gap;
      samples.push_back(
          {gyro.stamp, gyro.value, a.value + part * (b.value - a.value)});
    }
    gyro_.pop_front();
  }
  return samples;
}

}  // namespace rgbd_pose
