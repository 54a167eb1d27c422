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
  const std::string& path() const { return path_; }

  // Of its messages.
  WireFormat format() const { return format_; }

  // Those it has, each once.
  const std::vector<BagTopic>& topics() const { return topics_; }

  // The place of the topic of that name among them; -1: there is none.
  int FindTopic(const std::string& name) const {
    for (size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].name == name) return static_cast<int>(i);
    }
    return -1;
  }

  // The first messages of a topic, at most so many; does not disturb Next.
  virtual std::vector<BagMessage> First(int topic, int count) = 0;

  // From now on Next gives messages of these topics, from the first one.
  virtual void Select(const std::vector<int>& topics) = 0;

  // The next message in the order in which they were received; nothing after
  // the last one.
  virtual std::optional<BagMessage> Next() = 0;

 protected:
  BagReader(const std::string& path, WireFormat format)
      : path_(path), format_(format) {}

  const std::string path_;
  WireFormat format_;
  std::vector<BagTopic> topics_;  // for the reader to fill in
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

// By the recorder: .bag files; or .db3 (sqlite3) and .mcap files, of which an
// .mcap may be of ROS 1.
enum class BagKind { kRos1, kRos2 };

// Whether a path is a bag of this kind, one that can be read or not: a file, or
// a folder of the files of one recording.
bool IsBag(const std::string& path, BagKind kind);

// Opens it. Throws InputError for what is no bag, for files that are not closed
// or packed as a whole by something else than zstd, for files of several
// recordings or cameras, and for .db3 in a build without sqlite3.
std::unique_ptr<BagReader> OpenBag(const std::string& path, BagKind kind);

// Open one file of a kind. Throw InputError if it is not one. A bag of ROS 1
// (also what the RealSense viewer records) must have been closed; each of its
// chunks is unpacked once, also where their times overlap. Of an mcap file only
// messages of ROS 2 (cdr) or ROS 1 are read.
std::unique_ptr<BagReader> OpenRos1Bag(const std::string& path);
std::unique_ptr<BagReader> OpenBagDatabase(const std::string& path);
std::unique_ptr<BagReader> OpenMcapFile(const std::string& path);

}  // namespace rgbd_pose
