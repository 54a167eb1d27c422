#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/bags/bag_reader.h"
#include "frontend/bags/chunk_codec.h"
#include "frontend/bags/ros_messages.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kMcap[] = ".mcap";
constexpr char kPacked[] = ".zstd";
constexpr char kUnclosed[] = ".active";

bool IsPartOfBag(const fs::path& path, BagKind kind) {
  const bool is_ros1 = kind == BagKind::kRos1;
  const fs::path name = path.extension() == (is_ros1 ? kUnclosed : kPacked)
                            ? path.stem()
                            : path.filename();
  const fs::path ending = name.extension();
  return is_ros1 ? ending == ".bag" || ending == ".BAG"
                 : ending == ".db3" || ending == kMcap;
}

// Makes a folder for the decompressed copy of a file that its recorder
// compressed as a whole. It is removed with the result.
std::shared_ptr<const fs::path> TemporaryFolderFor(const fs::path& packed) {
  std::error_code error;
  std::string folder =
      (fs::temp_directory_path(error) / "rgbd_pose-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw InputError(
        packed.string() + ": cannot be decompressed: the temporary folder " +
        folder + " could not be created; set TMPDIR to a writable folder");
  }
  return {new fs::path(folder), [](const fs::path* path) {
            std::error_code ignored;
            fs::remove_all(*path, ignored);
            delete path;
          }};
}

// Whether files are the parts of one recording: NAME_0.bag, NAME_1.bag, ...
// NAME may differ between the parts, as it may contain a date.
bool AreNumbered(const std::vector<fs::path>& files) {
  std::set<std::string> numbers;
  for (const fs::path& file : files) {
    const bool is_closed = file.extension() != kUnclosed;
    const std::string stem = (is_closed ? file : file.stem()).stem().string();
    const size_t place = stem.find_last_not_of("0123456789");
    if (place == stem.npos || stem[place] != '_' ||
        !numbers.insert(stem.substr(place)).second) {
      return false;
    }
  }
  return true;
}

// The files of a bag in order. None if .bag files are not of one recording.
std::vector<fs::path> FilesOf(const std::string& path, BagKind kind) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    if (IsPartOfBag(entry.path(), kind)) files.push_back(entry.path());
  }
  // Natural order: NAME_2.db3 comes before NAME_10.db3.
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    return std::pair(a.native().size(), a.native()) <
           std::pair(b.native().size(), b.native());
  });
  if (kind == BagKind::kRos1 && !AreNumbered(files)) return {};
  return files;
}

// Reads the files of a recording one after the other.
class BagFiles final : public BagReader {
 public:
  BagFiles(const std::string& path, const std::vector<fs::path>& files,
           BagKind kind)
      : BagReader(path, WireFormat::kCdr) {
    for (fs::path file : files) {
      if (file.extension() == kPacked) {
        unpacked_.push_back(TemporaryFolderFor(file));
        const fs::path copy = *unpacked_.back() / file.stem();
        UnpackZstdFile(file.string(), copy.string());
        file = copy;
      }
      files_.push_back(kind == BagKind::kRos1      ? OpenRos1Bag(file)
                       : file.extension() == kMcap ? OpenMcapFile(file)
                                                   : OpenBagDatabase(file));
      if (files_.size() == 1) format_ = files_.back()->format();
      if (files_.back()->format() != format_) {
        throw InputError(file.string() +
                         ": has messages of a different ROS version than the "
                         "previous files");
      }
      for (const BagTopic& topic : files_.back()->topics()) {
        if (FindTopic(topic.name) == nullptr) topics_.push_back(topic);
      }
      if (files.size() > 1) CheckCameras(files_.back().get());
    }
  }

  std::vector<BagMessage> First(const std::string& topic, int count) override {
    std::vector<BagMessage> first;
    for (const auto& file : files_) {
      if (file->FindTopic(topic) == nullptr) continue;
      const int missing = count - static_cast<int>(first.size());
      for (BagMessage& message : file->First(topic, missing)) {
        first.push_back(std::move(message));
      }
    }
    return first;
  }

  Messages MessagesOf(const std::vector<std::string>& topics) override {
    std::vector<Messages> parts;
    for (const auto& file : files_) parts.push_back(file->MessagesOf(topics));
    return [parts, at = size_t{0}]() mutable -> std::optional<BagMessage> {
      for (; at < parts.size(); ++at) {
        if (auto message = parts[at]()) return message;
      }
      return std::nullopt;
    };
  }

 private:
  // Checks that the cameras of a file are the same as in the files before.
  void CheckCameras(BagReader* file) {
    for (const BagTopic& topic : file->topics()) {
      if (topic.type != "sensor_msgs/CameraInfo") continue;
      const auto first = file->First(topic.name, 1);
      if (first.empty()) continue;
      const auto info = ReadMessage(*file, first.front(), ReadRosCameraInfo);
      std::vector<double> camera(info.k.begin(), info.k.end());
      camera.insert(camera.end(), info.d.begin(), info.d.end());
      camera.push_back(info.width);
      camera.push_back(info.height);
      const auto known = cameras_.emplace(topic.name, camera).first;
      if (known->second != camera) {
        throw InputError(file->path() + ": " + topic.name +
                         ": is from a different camera than in the previous "
                         "files; move this file to a separate folder");
      }
    }
  }

  std::vector<std::shared_ptr<const fs::path>> unpacked_;
  std::vector<std::unique_ptr<BagReader>> files_;
  std::map<std::string, std::vector<double>> cameras_;  // by CameraInfo topic
};

}  // namespace

bool IsBag(const std::string& path, BagKind kind) {
  std::error_code error;
  if (fs::is_directory(path, error)) return !FilesOf(path, kind).empty();
  return IsFile(path) && IsPartOfBag(path, kind);
}

std::unique_ptr<BagReader> OpenBag(const std::string& path, BagKind kind) {
  const std::vector<fs::path> files = FilesOf(path, kind);
  if (files.empty()) {
    throw InputError(path + (kind == BagKind::kRos1
                                 ? ": has no .bag file, or several that are "
                                   "not NAME_0.bag, NAME_1.bag, ...; give one"
                                 : ": has no .db3 or .mcap file"));
  }
  return std::make_unique<BagFiles>(path, files, kind);
}

}  // namespace rgbd_pose
