#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/named_values.h"
#include "frontend/bags/wire_reader.h"

namespace rgbd_pose {

struct BagTopic {
  std::string name;  // with the leading slash
  std::string type;  // in the form of ROS 1: sensor_msgs/Image
};

// A message as stored in the bag, not yet parsed.
struct BagMessage {
  std::string topic;                         // its name
  double received = 0.0;                     // time of the recorder, s
  std::shared_ptr<const std::string> bytes;  // never null
};

// Reads the messages of a bag of any kind. Not thread-safe. All calls throw
// InputError if the file is damaged.
class BagReader {
 public:
  virtual ~BagReader() = default;

  // For error messages.
  const std::string& path() const { return path_; }

  WireFormat format() const { return format_; }

  const std::vector<BagTopic>& topics() const { return topics_; }

  // Null if there is none of this name.
  const BagTopic* FindTopic(const std::string& name) const {
    return FindNamed(topics_, name);
  }

  // Gives the next message at each call; nothing after the last one, then it
  // must not be called again. The reader must outlive it.
  using Messages = std::function<std::optional<BagMessage>()>;

  // The messages of these topics in the order of reception. Where a recording
  // was not finished, its end is an InputError after the last message.
  virtual Messages MessagesOf(const std::vector<std::string>& topics) = 0;

  // The first messages of a topic, at most `count`.
  virtual std::vector<BagMessage> First(const std::string& topic, int count) {
    return Take(MessagesOf({topic}), count);
  }

 protected:
  static std::vector<BagMessage> Take(const Messages& next, int count) {
    std::vector<BagMessage> first;
    while (static_cast<int>(first.size()) < count) {
      std::optional<BagMessage> message = next();
      if (!message.has_value()) break;
      first.push_back(*std::move(message));
    }
    return first;
  }

  BagReader(const std::string& path, WireFormat format)
      : path_(path), format_(format) {}

  // Adds a topic by its number in the file. It has one for each publisher.
  void AddTopic(int64_t number, const std::string& name, std::string type) {
    constexpr std::string_view kRos2Part = "/msg/";
    const size_t place = type.find(kRos2Part);
    if (place != type.npos) type.replace(place, kRos2Part.size(), "/");
    if (FindTopic(name) == nullptr) topics_.push_back({name, type});
    names_[number] = name;
  }

  std::set<int64_t> NumbersOf(const std::vector<std::string>& topics) const {
    std::set<int64_t> numbers;
    for (const auto& [number, name] : names_) {
      if (std::count(topics.begin(), topics.end(), name) > 0) {
        numbers.insert(number);
      }
    }
    return numbers;
  }

  const std::string path_;
  WireFormat format_;
  std::vector<BagTopic> topics_;
  std::map<int64_t, std::string> names_;  // of topics by number
};

// Parses a message by `read`, which takes a WireReader. Adds the names of the
// bag and the topic to an InputError.
template <typename Read>
auto ReadMessage(const BagReader& bag, const BagMessage& message, Read read) {
  return Located(bag.path() + ": " + message.topic, [&] {
    return read(WireReader(*message.bytes, bag.format()));
  });
}

// kRos1: .bag files. kRos2: .db3 (sqlite3) and .mcap files; an .mcap file may
// also hold messages of ROS 1.
enum class BagKind { kRos1, kRos2 };

// Whether a path is a bag of this kind, judged by file names: a file, or a
// folder with the files of one recording.
bool IsBag(const std::string& path, BagKind kind);

// Opens a bag. Throws InputError if the path is not a bag, if the files are of
// several recordings or cameras, and for .db3 in a build without sqlite3.
std::unique_ptr<BagReader> OpenBag(const std::string& path, BagKind kind);

// Open one file. Throw InputError if it is not of this kind. Of an mcap file
// only messages of ROS are read.
std::unique_ptr<BagReader> OpenRos1Bag(const std::string& path);
std::unique_ptr<BagReader> OpenBagDatabase(const std::string& path);
std::unique_ptr<BagReader> OpenMcapFile(const std::string& path);

}  // namespace rgbd_pose
