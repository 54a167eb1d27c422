#include "frontend/bags/mcap_file.h"

#include <map>
#include <set>
#include <utility>

#include "frontend/bags/mcap_records.h"

namespace rgbd_pose {
namespace {

class McapFile final : public BagReader {
 public:
  explicit McapFile(const std::string& path)
      : path_(path), channels_(FindChannels(path)) {
    std::string encodings;
    bool is_ros2 = false;
    for (const auto& [number, channel] : channels_) {
      is_ros2 = is_ros2 || channel.encoding == "cdr";
    }
    format_ = is_ros2 ? WireFormat::kCdr : WireFormat::kRos1;
    const std::string known = is_ros2 ? "cdr" : "ros1";
    std::map<std::string, int> places;
    for (const auto& [number, channel] : channels_) {
      if (channel.encoding != known) {
        encodings += (encodings.empty() ? "" : ", ") + channel.encoding;
        continue;
      }
      // A topic has a channel for each that published it.
      const auto [place, is_new] =
          places.emplace(channel.topic, static_cast<int>(topics_.size()));
      if (is_new) topics_.push_back({channel.topic, Ros1Type(channel.type)});
      places_[number] = place->second;
    }
    if (topics_.empty() && !encodings.empty()) {
      throw InputError(path + ": has messages of " + encodings +
                       ", and only those of ROS (cdr, ros1) are read");
    }
  }

  const std::string& path() const override { return path_; }
  WireFormat format() const override { return format_; }
  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<BagMessage> First(int topic, int count) override {
    std::vector<BagMessage> first;
    McapRecords records(path_);
    while (static_cast<int>(first.size()) < count) {
      std::optional<BagMessage> message;
      try {
        message = NextOf(&records, {topic});
      } catch (const InputError&) {
        // Where there are some Next will say so as it comes to it.
        if (first.empty() && !records.is_cut_off()) throw;
        break;
      }
      if (!message.has_value()) break;
      first.push_back(*std::move(message));
    }
    return first;
  }

  void Select(const std::vector<int>& topics) override {
    selected_ = {topics.begin(), topics.end()};
    records_ = std::make_unique<McapRecords>(path_);
  }

  std::optional<BagMessage> Next() override {
    if (records_ == nullptr) return std::nullopt;
    return NextOf(records_.get(), selected_);
  }

 private:
  // Of the summary; where there is none the whole file is read once.
  static McapChannels FindChannels(const std::string& path) {
    McapRecords records(path);
    if (auto summary = records.ReadSummary()) return *std::move(summary);
    try {
      while (records.Next().has_value()) {
      }
    } catch (const InputError&) {
      if (records.channels().empty()) throw;
    }
    return records.channels();
  }

  std::optional<BagMessage> NextOf(McapRecords* records,
                                   const std::set<int>& topics) const {
    while (const std::optional<McapMessage> message = records->Next()) {
      const auto place = places_.find(message->channel);
      if (place == places_.end() || topics.count(place->second) == 0) continue;
      return BagMessage{place->second, 1e-9 * message->log_time,
                        std::make_shared<std::string>(message->bytes)};
    }
    return std::nullopt;
  }

  std::string path_;
  McapChannels channels_;
  WireFormat format_ = WireFormat::kCdr;
  std::vector<BagTopic> topics_;
  std::map<uint16_t, int> places_;  // of channels, among the topics
  std::set<int> selected_;
  std::unique_ptr<McapRecords> records_;  // of Next
};

}  // namespace

std::unique_ptr<BagReader> OpenMcapFile(const std::string& path) {
  return std::make_unique<McapFile>(path);
}

}  // namespace rgbd_pose
