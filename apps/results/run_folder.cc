#include "apps/results/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kAside[] = ".rgbd_odometry.partial";
constexpr char kLast[] = "metrics.json";

[[noreturn]] void FailOnFolder(const fs::path& folder,
                               const std::error_code& error) {
  throw InputError("--output: " + folder.string() +
                   " cannot be created or written (" + error.message() + ")");
}

// Removes the debug images that runs write, named by frame number (000123.png,
// 000123_residuals.png). Other files stay.
void RemoveDebugImages(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> ours;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const size_t digits = name.find_first_not_of("0123456789");
    if (digits < 6 || digits == std::string::npos) continue;
    const std::string rest = name.substr(digits);
    if (rest == ".png" || rest == "_residuals.png")
      ours.push_back(entry.path());
  }
  for (const fs::path& image : ours) fs::remove(image);
  fs::remove(folder, error);  // if empty
}

// Whether `file` is still the folder at `path`.
bool IsAt(int file, const fs::path& path) {
  struct stat open_one, one_there;
  return fstat(file, &open_one) == 0 && stat(path.c_str(), &one_there) == 0 &&
         open_one.st_dev == one_there.st_dev &&
         open_one.st_ino == one_there.st_ino;
}

}  // namespace

RunFolder::RunFolder(const std::string& path)
    : path_(path), staging_dir_(path_ / kAside) {
  std::error_code error;
  is_new_ = fs::create_directories(path_, error);
  if (error) FailOnFolder(path_, error);
  // The previous run removes the staging folder when it ends. A run that opened
  // the folder just before must create and lock it again.
  do {
    if (lock_ >= 0) close(lock_);
    fs::create_directories(staging_dir_, error);
    if (error) FailOnFolder(path_, error);
    lock_ = open(staging_dir_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0 && errno == ENOENT) continue;
    if (lock_ < 0) FailOnFolder(path_, {errno, std::generic_category()});
    // File systems without locks are accepted.
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(lock_);
      throw InputError("--output: " + path_.string() +
                       ": another program is writing its results here; wait "
                       "for it or choose another folder");
    }
  } while (!IsAt(lock_, staging_dir_));
  for (const auto& entry : fs::directory_iterator(staging_dir_, error)) {
    fs::remove_all(entry, error);  // left by a killed run
  }
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  fs::remove_all(staging_dir_, ignored);
  if (is_new_) fs::remove(path_, ignored);  // if empty
  close(lock_);
}

void RunFolder::WriteFile(const char* name, const std::string& content) const {
  WriteFileAtomically(staging_dir_ / name, content);
}

void RunFolder::Publish() {
  try {
    for (const char* name :
         {kLast, "report.html", "errors.csv", "trajectory.txt", "frames.csv",
          "edges.csv", "config.flags", "cloud_preview.json",
          "mesh_preview.json", "slam.csv", "keyframes.csv", "graph.g2o",
          "trajectory_online.txt", "trajectory_odometry.txt"}) {
      fs::remove(path_ / name);
    }
    RemoveDebugImages(path_ / "debug");
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(staging_dir_)) {
      const fs::path file = entry.path().lexically_relative(staging_dir_);
      if (!entry.is_directory() && file != kLast) files.push_back(file);
    }
    for (const fs::path& file : files) {
      fs::create_directories((path_ / file).parent_path());
      fs::rename(staging_dir_ / file, path_ / file);
    }
    fs::rename(staging_dir_ / kLast, path_ / kLast);
  } catch (const fs::filesystem_error& error) {
    FailOnFolder(path_, error.code());
  }
}

}  // namespace rgbd_pose
