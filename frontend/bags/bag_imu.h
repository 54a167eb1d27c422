#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/inertial/imu_merger.h"
#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// The topics of the inertial sensor of a recording, of sensor_msgs/Imu.
struct ImuTopics {
  std::string accel;  // empty: there is no sensor, or a gyroscope alone
  std::string gyro;   // the same topic if its messages have both; empty: none

  // Whether other topics were suitable as well.
  bool had_choice = false;

  bool is_split() const { return !gyro.empty() && gyro != accel; }
};

// Whether the bag has such a topic of inertial messages.
bool IsImuTopic(const BagReader& bag, const std::string& name);

// Chooses the topics among `names` or, if these are empty, among all of the
// bag: one with both quantities before separate ones, as a RealSense has them
// (.../gyro/sample, .../accel/sample), and those named most like `color`.
// Throws InputError for names that are neither one topic nor these two.
ImuTopics ChooseImuTopics(const BagReader& bag,
                          const std::vector<std::string>& names,
                          const std::string& color);

// Reads the messages of an inertial sensor as one stream of samples.
class BagImu {
 public:
  // Reads the first messages. Throws InputError if their units are wrong.
  BagImu(BagReader* bag, const ImuTopics& topics);

  // The coordinate frame of the samples; nothing if there are no messages.
  const std::optional<std::string>& frame_id() const { return frame_id_; }

  bool has_gyro() const { return has_gyro_; }

  // What ExamineImu says of the first samples that Add has returned, 2000 at
  // most; empty if nothing.
  std::string Warning() const;

  // Adds a message, and returns the samples that are known since the last call.
  std::vector<ImuSample> Add(const BagMessage& message);

 private:
  void CheckFirst();
  std::vector<ImuSample> Read(const BagMessage& message);

  BagReader* bag_;
  ImuTopics topics_;
  std::optional<std::string> frame_id_;
  bool has_gyro_ = true;
  std::vector<ImuSample> samples_;  // the first ones
  ImuMerger merger_;
};

}  // namespace rgbd_pose
