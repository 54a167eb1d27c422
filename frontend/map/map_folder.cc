#include "frontend/map/map_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <set>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/map/map_index.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kIndex[] = "map.txt";
constexpr char kImageType[] = ".png";

// Locks a folder for this process. The lock ends with the process in any case.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    // On file systems without locks, this continues without one.
    if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(file_);
      throw InputError(folder.string() +
                       ": another program is saving a map here; wait for it or "
                       "choose another folder");
    }
  }
  ~FolderLock() { close(file_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  const int file_;
};

// Whether a file is an image of a map, complete or still being written.
bool IsImage(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::string checksum = name.substr(0, name.find('.'));
  const std::string whole = checksum + kImageType;
  return IsImageName(checksum) &&
         (name == whole || name == TemporaryPath(whole));
}

// Creates a folder and its missing parents and syncs them to disk.
void MakeFolder(const fs::path& folder) {
  std::vector<fs::path> above;
  for (fs::path path = fs::absolute(folder); !fs::exists(path);) {
    path = path.parent_path();
    above.push_back(path);
  }
  fs::create_directories(folder);
  for (const fs::path& path : above) SyncFolder(path.string());
}

// Throws InputError if a folder without a map contains other files.
void RequireNoOtherThings(const fs::path& folder) {
  if (fs::exists(folder / kIndex)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    // Left by a program that was killed before its first map was complete.
    if (IsImage(entry.path()) ||
        entry.path().filename() == TemporaryPath(kIndex)) {
      continue;
    }
    throw InputError(folder.string() +
                     ": contains files that are not part of a map; choose an "
                     "empty or new folder");
  }
}

// Writes an image unless it is there. Returns the name of its file.
std::string SaveImage(const fs::path& folder, const PngBytes& image) {
  std::string name = image.checksum + kImageType;
  std::error_code error;
  // The size is -1 if the file does not exist.
  if (fs::file_size(folder / name, error) != image.bytes.size()) {
    WriteFileAtomically((folder / name).string(), image.bytes,
                        Durability::kPowerLoss);
  }
  return name;
}

void Save(const fs::path& folder, const KeyframeMap& map) {
  MapIndex index = {map, {}};
  std::set<std::string> used;
  for (const Keyframe& keyframe : map.keyframes) {
    const StoredImages& images = keyframe.images;
    used.insert(SaveImage(folder, *images.gray));
    used.insert(SaveImage(folder, *images.depth));
    index.images.push_back({images.gray->checksum, images.depth->checksum});
  }
  // The images must be on disk before the index that names them. Images of the
  // old index must stay until the new index has replaced it.
  SyncFolder(folder.string());
  WriteFileAtomically((folder / kIndex).string(), FormatMapIndex(index),
                      Durability::kPowerLoss);
  SyncFolder(folder.string());
  std::vector<fs::path> unused;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& file = entry.path();
    if (IsImage(file) && used.count(file.filename().string()) == 0) {
      unused.push_back(file);
    }
  }
  std::error_code ignored;  // the new map is saved
  for (const fs::path& file : unused) fs::remove(file, ignored);
}

std::shared_ptr<const PngBytes> LoadImage(const fs::path& folder,
                                          const std::string& checksum) {
  const fs::path file = folder / (checksum + kImageType);
  if (!PathExists(file)) {
    throw InputError(file.string() +
                     ": image of a keyframe is missing; restore a copy of the "
                     "map or create it again");
  }
  auto image = std::make_shared<const PngBytes>(ReadTextFile(file.string()));
  if (image->checksum != checksum) {
    throw InputError(file.string() +
                     ": is damaged (wrong checksum); restore a copy of the map "
                     "or create it again");
  }
  return image;
}

KeyframeMap LoadIndexed(const fs::path& folder, const std::string& text) {
  const std::string path = (folder / kIndex).string();
  MapIndex index = ParseMapIndex(text, path);
  for (size_t i = 0; i < index.images.size(); ++i) {
    StoredImages& images = index.map.keyframes[i].images;
    images.gray = LoadImage(folder, index.images[i].gray);
    images.depth = LoadImage(folder, index.images[i].depth);
  }
  RequireSound(index.map.Check(), path + ": ");
  return std::move(index.map);
}

// Runs `call` with the folder created, locked and found to be a map's. Converts
// file system errors to InputError.
template <typename Call>
void InMapFolder(const std::string& folder, Call call) {
  try {
    MakeFolder(folder);
    const FolderLock lock(folder);
    RequireNoOtherThings(folder);
    call();
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder + ": no map can be saved here (" +
                     error.code().message() + ")");
  }
}

}  // namespace

void SaveMap(const std::string& folder, const KeyframeMap& map) {
  RequireSound(map.Check(), folder + ": not saved: ");
  InMapFolder(folder, [&] { Save(folder, map); });
}

void RequireMapFolder(const std::string& folder) {
  InMapFolder(folder,
              [&] { RequireWritable((fs::path(folder) / kIndex).string()); });
}

KeyframeMap LoadMap(const std::string& folder) {
  const std::string path = (fs::path(folder) / kIndex).string();
  if (!PathExists(path)) {
    throw InputError(folder +
                     ": contains no map (no map.txt); choose a folder that a "
                     "map was saved to");
  }
  for (;;) {
    const std::string text = ReadTextFile(path);
    try {
      return LoadIndexed(folder, text);
    } catch (const InputError&) {
      // If the index changed, another program may have removed old images.
      if (ReadTextFile(path) == text) throw;
    }
  }
}

}  // namespace rgbd_pose
