#include "frontend/bags/bag_imu.h"

#include <algorithm>
#include <opencv2/core.hpp>

#include "core/inertial/imu_check.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/bags/ros_messages.h"

namespace rgbd_pose {
namespace {

constexpr char kImu[] = "sensor_msgs/Imu";

// Messages of a topic that are read when a bag is opened. In a compressed bag
// all images between them have to be unpacked.
constexpr int kFirst = 200;

// Samples that are examined while the bag is read: 10 s at 200 Hz, which is
// enough for ExamineImu to see axes.
constexpr size_t kExamined = 2000;

bool IsNamed(const std::string& topic, const char* part) {
  return cv::toLowerCase(topic).find(part) != std::string::npos;
}

// Whether the name says that only one of both quantities is measured.
bool IsOfGyro(const std::string& topic) {
  return IsNamed(topic, "gyro") && !IsNamed(topic, "accel");
}
bool IsOfAccel(const std::string& topic) {
  return IsNamed(topic, "accel") && !IsNamed(topic, "gyro");
}

// How many of their leading parts, as in /camera/color, two names share.
int CommonParts(const std::string& a, const std::string& b) {
  const std::vector<std::string> first = SplitText(a, '/');
  const std::vector<std::string> second = SplitText(b, '/');
  const size_t most = std::min(first.size(), second.size());
  size_t count = 0;
  while (count < most && first[count] == second[count]) ++count;
  return static_cast<int>(count);
}

// The topic named most like `name`; the first one of several; empty: none.
std::string Nearest(const std::vector<std::string>& topics,
                    const std::string& name) {
  std::string best;
  for (const std::string& topic : topics) {
    if (best.empty() || CommonParts(topic, name) > CommonParts(best, name)) {
      best = topic;
    }
  }
  return best;
}

}  // namespace

bool IsImuTopic(const BagReader& bag, const std::string& name) {
  const BagTopic* topic = bag.FindTopic(name);
  return topic != nullptr && topic->type == kImu;
}

ImuTopics ChooseImuTopics(const BagReader& bag,
                          const std::vector<std::string>& names,
                          const std::string& color) {
  std::vector<std::string> whole, gyro, accel;
  for (const BagTopic& topic : bag.topics()) {
    const bool is_wanted =
        names.empty() || std::count(names.begin(), names.end(), topic.name);
    if (topic.type != kImu || !is_wanted) continue;
    auto& of_kind = IsOfGyro(topic.name)    ? gyro
                    : IsOfAccel(topic.name) ? accel
                                            : whole;
    of_kind.push_back(topic.name);
  }
  ImuTopics chosen;
  if (!whole.empty()) {
    chosen.accel = chosen.gyro = Nearest(whole, color);
    chosen.had_choice = whole.size() > 1;
  } else if (!accel.empty()) {
    chosen.accel = Nearest(accel, color);
    chosen.gyro = Nearest(gyro, chosen.accel);
    chosen.had_choice = accel.size() > 1 || gyro.size() > 1;
  } else {
    chosen.gyro = Nearest(gyro, color);
  }
  const bool is_each_used = names.size() == (chosen.accel.empty() ? 0u
                                             : chosen.is_split()  ? 2u
                                                                  : 1u);
  if (names.empty() || is_each_used) return chosen;
  throw InputError(bag.path() + ": topics: " + Join(names) +
                   " are not one inertial sensor; give one topic with both "
                   "quantities, or one of a gyroscope and one of an "
                   "accelerometer with gyro and accel in their names");
}

BagImu::BagImu(BagReader* bag, const ImuTopics& topics)
    : bag_(bag), topics_(topics) {
  CheckFirst();
}

void BagImu::CheckFirst() {
  std::vector<BagMessage> first = bag_->First(topics_.accel, kFirst);
  if (first.empty()) return;
  const RosImu imu = ReadMessage(*bag_, first.front(), ReadRosImu);
  frame_id_ = imu.header.frame_id;
  has_gyro_ = !topics_.gyro.empty() && (topics_.is_split() || imu.has_gyro);
  if (topics_.is_split()) {
    for (BagMessage& message : bag_->First(topics_.gyro, kFirst)) {
      first.push_back(std::move(message));
    }
  }
  // In a bag the streams are mixed.
  std::stable_sort(first.begin(), first.end(),
                   [](const BagMessage& a, const BagMessage& b) {
                     return a.received < b.received;
                   });
  for (const BagMessage& message : first) Add(message);
  const std::string error = ExamineImu(samples_).error;
  if (!error.empty()) {
    throw InputError(bag_->path() + ": " + topics_.accel + ": " + error);
  }
  merger_ = ImuMerger();
  samples_.clear();
}

std::string BagImu::Warning() const {
  const ImuFindings findings = ExamineImu(samples_);
  return findings.error.empty() ? findings.warning : findings.error;
}

std::vector<ImuSample> BagImu::Add(const BagMessage& message) {
  const std::vector<ImuSample> samples = Read(message);
  for (const ImuSample& sample : samples) {
    if (samples_.size() < kExamined) samples_.push_back(sample);
  }
  return samples;
}

std::vector<ImuSample> BagImu::Read(const BagMessage& message) {
  const RosImu imu = ReadMessage(*bag_, message, ReadRosImu);
  // Without a stamp in the header, the time of recording is used.
  const double stamp =
      imu.header.stamp > 0.0 ? imu.header.stamp : message.received;
  if (!topics_.is_split()) {
    return {{stamp, has_gyro_ ? imu.gyro : Eigen::Vector3d::Zero(), imu.accel}};
  }
  if (message.topic == topics_.gyro) {
    merger_.AddGyro(stamp, imu.gyro);
  } else {
    merger_.AddAccel(stamp, imu.accel);
  }
  return merger_.Take();
}

}  // namespace rgbd_pose
