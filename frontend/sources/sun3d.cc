#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/units.h"
#include "frontend/files/image_file.h"
#include "frontend/sources/camera_matrix.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/image_pairing.h"
#include "frontend/sources/masks.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

struct TimedImage {
  double timestamp = 0.0;  // s
  std::string path;
};

// The time (s) in a name such as 0000001-000000033369: number, microseconds.
std::optional<double> TimeIn(const std::string& name) {
  constexpr double kMicrosecondsPerSecond = 1e6;
  const std::vector<std::string> parts = SplitText(name, '-');
  if (parts.size() != 2 || !ParseWhole(parts[0])) return std::nullopt;
  const char* const end = parts[1].data() + parts[1].size();
  uint64_t time = 0;
  const auto [last, error] = std::from_chars(parts[1].data(), end, time);
  if (error != std::errc() || last != end) return std::nullopt;
  return static_cast<double>(time) / kMicrosecondsPerSecond;
}

// The images of the first folder with any, by time, each time once.
std::vector<TimedImage> TimedImages(const std::string& folder,
                                    const std::vector<const char*>& choices) {
  std::vector<TimedImage> images;
  for (const char* choice : choices) {
    std::set<fs::path> paths;
    std::error_code error;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(fs::path(folder) / choice, error)) {
      paths.insert(entry.path());
    }
    for (const fs::path& path : paths) {
      const std::optional<double> time = TimeIn(path.stem().string());
      if (time.has_value()) images.push_back({*time, path.string()});
    }
    if (!images.empty()) break;
  }
  const auto is_earlier = [](const TimedImage& a, const TimedImage& b) {
    return a.timestamp < b.timestamp;
  };
  std::stable_sort(images.begin(), images.end(), is_earlier);
  const auto end = std::unique(images.begin(), images.end(),
                               [](const TimedImage& a, const TimedImage& b) {
                                 return a.timestamp == b.timestamp;
                               });
  images.erase(end, images.end());
  return images;
}

std::vector<TimedImage> ColorImages(const std::string& folder) {
  return TimedImages(folder, {"image", "rgb", "color"});
}

std::vector<TimedImage> DepthImages(const std::string& folder) {
  return TimedImages(folder, {"depth"});
}

// SUN3D stores millimetres rotated by 3 bits to the left.
cv::Mat ReadRotatedDepth(const std::string& path) {
  cv::Mat depth = ReadDepthImageFile(path).clone();
  for (uint16_t& raw : cv::Mat_<uint16_t>(depth)) {
    raw = static_cast<uint16_t>(raw >> 3 | raw << 13);
  }
  return depth;
}

class Sun3d final : public Dataset {
 public:
  explicit Sun3d(const SourceOptions& options)
      : folder_(options.path),
        pairs_(FindPairs(options.max_time_difference)),
        is_rotated_(IsRotated()),
        assembly_(ChooseSetup(options), options.keep_color) {}

  int size() const override { return static_cast<int>(pairs_.size()); }
  double timestamp(int index) const override {
    return pairs_[index].color.timestamp;
  }
  Frame Read(int index) const override {
    const auto& [color, depth] = pairs_[index];
    return assembly_.Read(
        {index, color.timestamp, depth.timestamp - color.timestamp}, color.path,
        depth.path, is_rotated_ ? ReadRotatedDepth : ReadDepthImageFile);
  }
  const RgbdCamera& camera() const override { return assembly_.camera(); }
  int unmatched_color() const override { return unmatched_color_; }

  std::vector<std::string> remarks() const override {
    std::vector<std::string> lines;
    if (is_rotated_) {
      lines.push_back(folder_ +
                      ": depth is taken for that of SUN3D, whose bits are "
                      "rotated, because its last 3 bits are 0");
    }
    std::vector<std::string> colors;
    for (const auto& pair : pairs_) colors.push_back(pair.color.path);
    const std::string masks = MaskRemark(colors);
    if (!masks.empty()) lines.push_back(masks);
    return lines;
  }

 private:
  std::vector<PairedImages<TimedImage>> FindPairs(double max_difference) {
    const std::vector<TimedImage> color = ColorImages(folder_);
    const std::vector<TimedImage> depth = DepthImages(folder_);
    std::vector<PairedImages<TimedImage>> pairs;
    for (const auto& [i, j] :
         Associate(TimesOf(color), TimesOf(depth), max_difference)) {
      pairs.push_back({color[i], depth[j]});
    }
    if (pairs.empty()) {
      throw InputError(
          folder_ +
          Format(": no colour image (image/ or rgb/: %zu) is within %g s of a "
                 "depth image (depth/: %zu) by the microseconds in their "
                 "names, such as 0000001-000000033369.png",
                 color.size(), max_difference, depth.size()));
    }
    unmatched_color_ = static_cast<int>(color.size() - pairs.size());
    return pairs;
  }

  // SUN3D's depth has 3 zero bits up to 8.2 m; that of other recordings is
  // hardly ever a multiple of 8 mm.
  bool IsRotated() const {
    constexpr size_t kMaxImages = 5;
    constexpr double kMostPixels = 0.9;
    int measured = 0, multiples = 0;
    for (size_t i = 0; i < std::min(pairs_.size(), kMaxImages); ++i) {
      cv::Mat depth;
      try {
        depth = ReadDepthImageFile(pairs_[i].depth.path);
      } catch (const InputError&) {
        continue;  // Read reports it
      }
      for (const uint16_t raw : cv::Mat_<uint16_t>(depth)) {
        measured += raw != 0 ? 1 : 0;
        multiples += raw != 0 && raw % 8 == 0 ? 1 : 0;
      }
    }
    return measured > 0 && multiples >= kMostPixels * measured;
  }

  CameraSetup ChooseSetup(const SourceOptions& options) const {
    std::optional<CameraSetup> own;
    const fs::path matrix = fs::path(folder_) / "intrinsics.txt";
    if (!options.camera.has_value() && PathExists(matrix)) {
      own = CameraSetup(
          ReadCameraMatrix(matrix.string(), pairs_.front().color.path));
    }
    CameraSetup setup = ChooseCamera(options, own);
    if (!setup.depth_scale) setup.depth_scale = kMillimetresPerMetre;
    return setup;
  }

  std::string folder_;
  int unmatched_color_ = 0;
  std::vector<PairedImages<TimedImage>> pairs_;  // by time; never empty
  bool is_rotated_;                              // as SUN3D stores depth
  FrameAssembly assembly_;
};

}  // namespace

bool IsSun3d(const std::string& folder) {
  return !ColorImages(folder).empty() && !DepthImages(folder).empty();
}

std::unique_ptr<FrameSource> OpenSun3d(const SourceOptions& options) {
  return std::make_unique<Sun3d>(options);
}

}  // namespace rgbd_pose
