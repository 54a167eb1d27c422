#include "frontend/slam/map_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <memory>
#include <set>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kIndex[] = "map.txt";
constexpr char kImageType[] = ".png";

// Locks a folder until the result is destroyed or the process ends.
std::shared_ptr<void> LockFolder(const fs::path& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  std::shared_ptr<void> lock(nullptr, [file](void*) { close(file); });
  // On file systems without locks, this continues without one.
  if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw InputError(folder.string() +
                     ": another program is saving a map here; wait for it or "
                     "choose another folder");
  }
  return lock;
}

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

// Throws InputError if a folder without a map of this version contains other
// files. A damaged map may be replaced.
void RequireNoOtherThings(const fs::path& folder) {
  if (const fs::path index = folder / kIndex; fs::exists(index)) {
    RequireIndexFormat(ReadTextFile(index.string()), index.string());
    return;
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& file = entry.path();
    // A program that was killed before its first map was complete leaves such
    // files.
    if (IsImage(file) || file.filename() == TemporaryPath(kIndex)) continue;
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
  std::set<std::string> used;
  for (const Keyframe& keyframe : map.keyframes) {
    used.insert(SaveImage(folder, *keyframe.images.gray));
    used.insert(SaveImage(folder, *keyframe.images.depth));
  }
  // The images must be on disk before the index that names them. Images of the
  // old index must stay until the new index has replaced it.
  SyncFolder(folder.string());
  WriteFileAtomically((folder / kIndex).string(), FormatMapIndex(map),
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
  KeyframeMap map = ParseMapIndex(text, path);
  for (Keyframe& keyframe : map.keyframes) {
    for (auto* image : {&keyframe.images.gray, &keyframe.images.depth}) {
      *image = LoadImage(folder, (*image)->checksum);
    }
  }
  RequireSound(map.Check(), path + ": ");
  return map;
}

// Runs `call` with the folder created, locked and found to be a map's. Converts
// file system errors to InputError.
template <typename Call>
void InMapFolder(const std::string& folder, Call call) {
  try {
    MakeFolder(folder);
    const std::shared_ptr<void> lock = LockFolder(folder);
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

bool HasMap(const std::string& folder) {
  return PathExists((fs::path(folder) / kIndex).string());
}

KeyframeMap LoadMap(const std::string& folder) {
  const std::string path = (fs::path(folder) / kIndex).string();
  if (!HasMap(folder)) {
    throw InputError(folder +
                     (PathExists(folder) ? ": contains no map (no map.txt)"
                                         : ": no such folder") +
                     "; choose a folder that a map was saved to");
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
