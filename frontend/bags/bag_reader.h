#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/input_error.h"
#include "frontend/bags/wire_reader.h"

namespace rgbd_pose {

// A topic of a bag.
struct BagTopic {
  std::string name;  // with its slash
  std::string type;  // as in ROS 1: sensor_msgs/Image
};

// The name of a type in ROS 1: of sensor_msgs/msg/Image, sensor_msgs/Image.
inline std::string Ros1Type(std::string type) {
  constexpr std::string_view kPart = "/msg/";
  const size_t place = type.find(kPart);
  if (place != std::string::npos) type.replace(place, kPart.size(), "/");
  return type;
}

// A message as it is in the bag.
struct BagMessage {
  int topic = 0;                             // its place among the topics
  double received = 0.0;                     // by the recorder, s
  std::shared_ptr<const std::string> bytes;  // never null
};

// A file of messages, of whatever kind. One thread at a time. All calls throw
// InputError where the file is damaged.
class BagReader {
 public:
  virtual ~BagReader() = default;

  // What to call it in messages.
  virtual const std::string& path() const = 0;

  // Of its messages.
  virtual WireFormat format() const = 0;

  // Those it has, each once.
  virtual const std::vector<BagTopic>& topics() const = 0;

  // The first messages of a topic, at most so many; does not disturb Next.
  virtual std::vector<BagMessage> First(int topic, int count) = 0;

  // From now on Next gives messages of these topics, from the first one.
  virtual void Select(const std::vector<int>& topics) = 0;

  // The next message in the order in which they were received; nothing after
  // the last one.
  virtual std::optional<BagMessage> Next() = 0;
};

// Has a message read by `read`, which takes a WireReader. What that throws
// says which message it is of.
template <typename Read>
auto ReadMessage(const BagReader& bag, const BagMessage& message, Read read) {
  try {
    return read(WireReader(*message.bytes, bag.format()));
  } catch (const InputError& error) {
    throw InputError(bag.path() + ": " + bag.topics()[message.topic].name +
                     ": " + error.what());
  }
}

}  // namespace rgbd_pose
