#include "frontend/simulation/tum_writer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <filesystem>
#include <future>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <system_error>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/sources/image_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

std::string FormatStamp(double timestamp) {
  constexpr int kDecimals = 6;
  std::array<char, 400> buffer;  // the largest double has 309 digits
  const auto result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), timestamp,
                    std::chars_format::fixed, kDecimals);
  return std::string(buffer.data(), result.ptr);
}

// The shortest text that reads back as the same number.
std::string FormatExactly(double value) {
  std::array<char, 32> buffer;
  const auto result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

std::string ImagePath(const std::string& kind, double timestamp) {
  return kind + "/" + FormatStamp(timestamp) + ".png";
}

std::string FormatList(const SyntheticDataset& dataset,
                       const std::string& kind) {
  std::string text = "# timestamp filename\n";
  for (int i = 0; i < dataset.size(); ++i) {
    const double timestamp = dataset.timestamp(i);
    text += FormatStamp(timestamp) + " " + ImagePath(kind, timestamp) + "\n";
  }
  return text;
}

void WritePng(const fs::path& path, const cv::Mat& image) {
  // Sensor noise leaves no repetitions worth a search.
  WritePngFile(path.string(), image,
               {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY});
}

void WriteImages(const SyntheticDataset& dataset, const fs::path& folder,
                 const TumWriterOptions& options) {
  std::atomic<int> next = 0;
  std::mutex mutex;
  int done = 0;
  const auto work = [&] {
    for (int i = next++; i < dataset.size(); i = next++) {
      try {
        const RgbdImages images = dataset.ReadImages(i);
        const double timestamp = dataset.timestamp(i);
        WritePng(folder / ImagePath("rgb", timestamp), images.color);
        WritePng(folder / ImagePath("depth", timestamp), images.depth);
      } catch (...) {
        next = dataset.size();  // so that the others stop, too
        throw;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      ++done;
      if (options.progress) options.progress(done);
    }
  };
  std::vector<std::future<void>> workers;
  for (int i = 0; i < std::max(1, options.threads); ++i) {
    workers.push_back(std::async(std::launch::async, work));
  }
  for (std::future<void>& worker : workers) worker.wait();
  for (std::future<void>& worker : workers) worker.get();
}

void WriteAll(const SyntheticDataset& dataset, const fs::path& folder,
              const TumWriterOptions& options) {
  fs::create_directories(folder / "rgb");
  fs::create_directories(folder / "depth");
  WriteImages(dataset, folder, options);
  for (const std::string kind : {"rgb", "depth"}) {
    WriteFileAtomically((folder / (kind + ".txt")).string(),
                        FormatList(dataset, kind));
  }
  WriteFileAtomically((folder / "groundtruth.txt").string(),
                      FormatTrajectory(dataset.ground_truth()));
  WriteFileAtomically((folder / "camera.yaml").string(),
                      FormatCameraYaml(dataset.camera()));
}

}  // namespace

std::string FormatCameraYaml(const RgbdCamera& rgbd_camera) {
  const Camera& camera = rgbd_camera.camera;
  std::string text = "%YAML:1.0\n";
  const std::pair<const char*, double> values[] = {
      {"Camera.fx", camera.fx},
      {"Camera.fy", camera.fy},
      {"Camera.cx", camera.cx},
      {"Camera.cy", camera.cy},
      {"Camera.k1", camera.k1},
      {"Camera.k2", camera.k2},
      {"Camera.p1", camera.p1},
      {"Camera.p2", camera.p2},
      {"Camera.k3", camera.k3},
      {"Camera.width", camera.width},
      {"Camera.height", camera.height},
      {"DepthMapFactor", rgbd_camera.depth_scale}};
  for (const auto& [key, value] : values) {
    text += std::string(key) + ": " + FormatExactly(value) + "\n";
  }
  return text;
}

void WriteTumSequence(const SyntheticDataset& dataset,
                      const std::string& folder,
                      const TumWriterOptions& options) {
  fs::path target = fs::path(folder).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // "folder/"
  fs::path aside = target;
  aside += ".partial";
  try {
    if (fs::exists(target) &&
        (!fs::is_directory(target) || !fs::is_empty(target))) {
      throw InputError(folder +
                       ": is there already and no empty folder; remove it or "
                       "name another one");
    }
    fs::remove_all(aside);
    try {
      WriteAll(dataset, aside, options);
      fs::rename(aside, target);
    } catch (...) {
      std::error_code ignored;
      fs::remove_all(aside, ignored);
      throw;
    }
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder + ": cannot be written: " + error.code().message());
  }
}

}  // namespace rgbd_pose
