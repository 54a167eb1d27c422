#include "apps/batch/batch_hash.h"

#include <link.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/util/text_file.h"
#include "core/util/text_hash.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

bool IsFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

void AddFile(const fs::path& path, TextHash* hash) {
  hash->Add(IsFile(path) ? "file" : "none");
  if (IsFile(path)) hash->Add(ReadTextFile(path.string()));
}

int AddOwnLibrary(dl_phdr_info* library, size_t /*size*/, void* hash) {
  const fs::path path = library->dlpi_name;
  if (path.filename().string().rfind("librgbd_pose_", 0) == 0) {
    AddFile(path, static_cast<TextHash*>(hash));
  }
  return 0;  // go on
}

// Lines of any kind are taken; whether they make sense is found out by the run.
void AddImagesOf(const fs::path& folder, const char* list, TextHash* hash) {
  AddFile(folder / list, hash);
  if (!IsFile(folder / list)) return;
  for (const TextLine& line : ReadTextTable((folder / list).string())) {
    if (line.words.size() < 2) continue;
    std::error_code error;
    const auto size = fs::file_size(folder / line.words[1], error);
    hash->Add(error ? "none" : std::to_string(size));
  }
}

// What is below a folder of another kind, or a file: names, sizes and texts.
void AddAllOf(const fs::path& recording, TextHash* hash) {
  std::error_code error;
  std::vector<fs::path> files;
  if (IsFile(recording)) files.push_back(recording);
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(recording, error)) {
    if (entry.is_regular_file(error)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    hash->Add(file.lexically_relative(recording).string());
    const auto size = fs::file_size(file, error);
    hash->Add(error ? "none" : std::to_string(size));
    const std::string type = file.extension().string();
    if (type == ".txt" || type == ".json" || type == ".log") {
      AddFile(file, hash);
    }
  }
}

}  // namespace

std::string HashProgram(const std::string& path) {
  TextHash hash;
  AddFile(path, &hash);
  dl_iterate_phdr(AddOwnLibrary, &hash);
  return hash.Hex();
}

std::string HashSequence(const BatchSequence& sequence) {
  TextHash hash;
  if (IsFile(fs::path(sequence.folder) / "rgb.txt")) {
    AddImagesOf(sequence.folder, "rgb.txt", &hash);
    AddImagesOf(sequence.folder, "depth.txt", &hash);
    AddFile(fs::path(sequence.folder) / "groundtruth.txt", &hash);
  } else {
    AddAllOf(sequence.folder, &hash);
  }
  if (CameraPreset(sequence.camera)) {
    hash.Add(sequence.camera);
  } else {
    AddFile(sequence.camera, &hash);
  }
  return hash.Hex();
}

}  // namespace rgbd_pose
