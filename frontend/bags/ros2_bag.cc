#include "frontend/bags/ros2_bag.h"

#include <algorithm>
#include <filesystem>

#include "core/util/input_error.h"
#include "frontend/bags/bag_database.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kSqlite[] = ".db3";
constexpr char kMcap[] = ".mcap";
constexpr char kPacked[] = ".zstd";

bool IsPartOfBag(const fs::path& path) {
  const fs::path unpacked =
      path.extension() == kPacked ? path.stem() : path.filename();
  return unpacked.extension() == kSqlite || unpacked.extension() == kMcap;
}

// NAME_2.db3 comes before NAME_10.db3.
bool ComesBefore(const fs::path& a, const fs::path& b) {
  const std::string first = a.string();
  const std::string second = b.string();
  return first.size() != second.size() ? first.size() < second.size()
                                       : first < second;
}

// The files of a bag in their order.
std::vector<fs::path> FilesOf(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    if (IsPartOfBag(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), ComesBefore);
  return files;
}

// The databases of a recording, one after the other.
class Ros2Bag final : public BagReader {
 public:
  Ros2Bag(const std::string& path, const std::vector<fs::path>& files)
      : path_(path) {
    for (const fs::path& file : files) {
      databases_.push_back(OpenBagDatabase(file.string()));
      std::vector<int>& places = places_.emplace_back();
      for (const BagTopic& topic : databases_.back()->topics()) {
        places.push_back(PlaceOf(topic));
      }
    }
  }

  const std::string& path() const override { return path_; }
  WireFormat format() const override { return WireFormat::kCdr; }
  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<BagMessage> First(int topic, int count) override {
    std::vector<BagMessage> first;
    for (size_t i = 0; i < databases_.size(); ++i) {
      for (const int inner : InnerPlaces(i, {topic})) {
        const int missing = count - static_cast<int>(first.size());
        for (BagMessage& message : databases_[i]->First(inner, missing)) {
          message.topic = topic;
          first.push_back(std::move(message));
        }
      }
    }
    return first;
  }

  void Select(const std::vector<int>& topics) override {
    for (size_t i = 0; i < databases_.size(); ++i) {
      databases_[i]->Select(InnerPlaces(i, topics));
    }
    at_ = 0;
  }

  std::optional<BagMessage> Next() override {
    for (; at_ < databases_.size(); ++at_) {
      if (std::optional<BagMessage> message = databases_[at_]->Next()) {
        message->topic = places_[at_][message->topic];
        return message;
      }
    }
    return std::nullopt;
  }

 private:
  int PlaceOf(const BagTopic& topic) {
    for (size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].name == topic.name) return static_cast<int>(i);
    }
    topics_.push_back(topic);
    return static_cast<int>(topics_.size() - 1);
  }

  // Of the topics, among those of a database.
  std::vector<int> InnerPlaces(size_t database,
                               const std::vector<int>& topics) const {
    std::vector<int> inner;
    const std::vector<int>& places = places_[database];
    for (size_t i = 0; i < places.size(); ++i) {
      if (std::find(topics.begin(), topics.end(), places[i]) != topics.end()) {
        inner.push_back(static_cast<int>(i));
      }
    }
    return inner;
  }

  std::string path_;
  std::vector<std::unique_ptr<BagReader>> databases_;
  std::vector<std::vector<int>> places_;  // of each one's topics in topics_
  std::vector<BagTopic> topics_;
  size_t at_ = 0;  // the database that is read
};

}  // namespace

bool IsRos2Bag(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return !FilesOf(path).empty();
  return fs::is_regular_file(path, error) && IsPartOfBag(path);
}

std::unique_ptr<BagReader> OpenRos2Bag(const std::string& path) {
  const std::vector<fs::path> files = FilesOf(path);
  if (files.empty()) throw InputError(path + ": has no .db3 file of ROS 2");
  for (const fs::path& file : files) {
    if (file.extension() == kPacked) {
      throw InputError(file.string() +
                       ": is packed, and only plain .db3 files are read; "
                       "`unzstd` unpacks a file that is packed as a whole, "
                       "`ros2 bag convert` any bag");
    }
    if (file.extension() == kMcap) {
      throw InputError(
          file.string() +
          ": is in mcap, and only sqlite3 is read; `ros2 bag convert -i " +
          path +
          " -o to.yaml` makes one, with the line `output_bags: [{uri: NAME, "
          "storage_id: sqlite3, all: true}]` in to.yaml (from Jazzy on "
          "all_topics: true)");
    }
  }
  return std::make_unique<Ros2Bag>(path, files);
}

}  // namespace rgbd_pose
