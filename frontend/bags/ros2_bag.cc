#include "frontend/bags/ros2_bag.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "core/util/input_error.h"
#include "frontend/bags/bag_database.h"
#include "frontend/bags/chunk_codec.h"
#include "frontend/bags/mcap_file.h"

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

// A file that its recorder has packed as a whole, unpacked in a folder of its
// own for as long as this lives.
class UnpackedFile {
 public:
  explicit UnpackedFile(const fs::path& packed) {
    std::error_code error;
    std::string folder =
        (fs::temp_directory_path(error) / "rgbd_pose-XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) {
      throw InputError(packed.string() + ": cannot be unpacked below " +
                       folder + "; TMPDIR names another folder");
    }
    folder_ = folder;
    try {
      UnpackZstdFile(packed.string(), path(packed).string());
    } catch (const InputError&) {
      Remove();
      throw;
    }
  }
  ~UnpackedFile() { Remove(); }
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  // Of what was in `packed`.
  fs::path path(const fs::path& packed) const {
    return folder_ / packed.stem();
  }

 private:
  void Remove() {
    std::error_code error;
    fs::remove_all(folder_, error);
  }

  fs::path folder_;
};

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

// The files of a recording, one after the other.
class Ros2Bag final : public BagReader {
 public:
  Ros2Bag(const std::string& path, const std::vector<fs::path>& files)
      : path_(path) {
    for (fs::path file : files) {
      if (file.extension() == kPacked) {
        unpacked_.push_back(std::make_unique<UnpackedFile>(file));
        file = unpacked_.back()->path(file);
      }
      files_.push_back(file.extension() == kMcap
                           ? OpenMcapFile(file.string())
                           : OpenBagDatabase(file.string()));
      if (files_.back()->format() != format()) {
        throw InputError(file.string() +
                         ": has messages of another version of ROS than the "
                         "files before");
      }
      std::vector<int>& places = places_.emplace_back();
      for (const BagTopic& topic : files_.back()->topics()) {
        places.push_back(PlaceOf(topic));
      }
    }
  }

  const std::string& path() const override { return path_; }
  WireFormat format() const override { return files_.front()->format(); }
  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<BagMessage> First(int topic, int count) override {
    std::vector<BagMessage> first;
    for (size_t i = 0; i < files_.size(); ++i) {
      for (const int inner : InnerPlaces(i, {topic})) {
        const int missing = count - static_cast<int>(first.size());
        for (BagMessage& message : files_[i]->First(inner, missing)) {
          message.topic = topic;
          first.push_back(std::move(message));
        }
      }
    }
    return first;
  }

  void Select(const std::vector<int>& topics) override {
    for (size_t i = 0; i < files_.size(); ++i) {
      files_[i]->Select(InnerPlaces(i, topics));
    }
    at_ = 0;
  }

  std::optional<BagMessage> Next() override {
    for (; at_ < files_.size(); ++at_) {
      if (std::optional<BagMessage> message = files_[at_]->Next()) {
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
  std::vector<std::unique_ptr<UnpackedFile>> unpacked_;
  std::vector<std::unique_ptr<BagReader>> files_;
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
  if (files.empty()) {
    throw InputError(path + ": has no .db3 or .mcap file");
  }
  return std::make_unique<Ros2Bag>(path, files);
}

}  // namespace rgbd_pose
