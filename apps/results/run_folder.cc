#include "apps/results/run_folder.h"

#include <system_error>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kAside[] = ".rgbd_odometry.partial";
constexpr char kLast[] = "metrics.json";

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

}  // namespace

RunFolder::RunFolder(const std::string& path)
    : path_(path), staging_(path_ / kAside, "--output: " + path_.string()) {}

void RunFolder::WriteFile(const char* name, const std::string& content) const {
  WriteFileAtomically(staging_dir() / name, content);
}

void RunFolder::Publish() {
  try {
    // A camera or a noise of depth that was found may be an input of this run.
    for (const char* name :
         {kLast, "report.html", "errors.csv", "trajectory.txt", "frames.csv",
          "edges.csv", "config.flags", "cloud_preview.json",
          "mesh_preview.json", "slam.csv", "keyframes.csv", "graph.g2o",
          "trajectory_online.txt", "trajectory_odometry.txt",
          "calibration.html", "residuals.csv"}) {
      fs::remove(path_ / name);
    }
    RemoveDebugImages(path_ / "debug");
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(staging_dir())) {
      const fs::path file = entry.path().lexically_relative(staging_dir());
      if (!entry.is_directory() && file != kLast) files.push_back(file);
    }
    for (const fs::path& file : files) {
      fs::create_directories((path_ / file).parent_path());
      fs::rename(staging_dir() / file, path_ / file);
    }
    fs::rename(staging_dir() / kLast, path_ / kLast);
  } catch (const fs::filesystem_error& error) {
    throw InputError("--output: " + path_.string() + " cannot be written (" +
                     error.code().message() + ")");
  }
}

}  // namespace rgbd_pose
