#include <charconv>
#include <filesystem>
#include <map>
#include <optional>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/sources/dataset.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// The number between prefix and suffix; nothing if the name does not match.
std::optional<int> NumberIn(const std::string& name,
                            const NumberedFiles& files) {
  const size_t around = files.prefix.size() + files.suffix.size();
  if (name.size() <= around ||
      name.compare(0, files.prefix.size(), files.prefix) != 0 ||
      name.compare(name.size() - files.suffix.size(), files.suffix.size(),
                   files.suffix) != 0) {
    return std::nullopt;
  }
  const char* begin = name.data() + files.prefix.size();
  const char* end = name.data() + name.size() - files.suffix.size();
  int number = 0;
  const auto [rest, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || rest != end || number < 0) return std::nullopt;
  return number;
}

// Paths by number, of the first alternative with any images.
std::map<int, std::string> List(const std::string& folder,
                                const std::vector<NumberedFiles>& choices) {
  std::map<int, std::string> found;
  for (const NumberedFiles& files : choices) {
    std::error_code error;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(fs::path(folder) / files.folder, error)) {
      const std::string name = entry.path().filename().string();
      const std::optional<int> number = NumberIn(name, files);
      if (number.has_value()) found[*number] = entry.path().string();
    }
    if (!found.empty()) break;
  }
  return found;
}

// "color/123.jpg or rgb/123.png"
std::string Examples(const std::vector<NumberedFiles>& choices) {
  std::string text;
  for (const NumberedFiles& files : choices) {
    text += (text.empty() ? "" : " or ") + files.folder +
            (files.folder.empty() ? "" : "/") + files.prefix + "123" +
            files.suffix;
  }
  return text;
}

class NumberedDataset final : public Dataset {
 public:
  NumberedDataset(const NumberedLayout& layout, const SourceOptions& options)
      : layout_(layout),
        folder_(options.path),
        frames_(FindFrames()),
        assembly_(MakeAssembly(options)) {}

  bool Recognises(const NumberedLayout& layout, const std::string& folder) {
    return PathExists(fs::path(folder) / layout.mark) &&
           !List(folder, layout.color).empty() &&
           !List(folder, layout.depth).empty();
  }

  int size() const override { return static_cast<int>(frames_.size()); }
  double timestamp(int index) const override {
    return frames_[index].number / kNumberedRate;
  }
  Frame Read(int index) const override {
    const NumberedFrame& files = frames_[index];
    Frame frame = assembly_.Read(files.color_path, files.depth_path);
    frame.index = index;
    frame.timestamp = timestamp(index);
    return frame;
  }
  const RgbdCamera& camera() const override { return assembly_.camera(); }
  Trajectory ground_truth() const override {
    std::vector<int> numbers;
    for (const NumberedFrame& frame : frames_) numbers.push_back(frame.number);
    Trajectory truth;
    for (const auto& [number, pose] : layout_.poses(folder_, numbers)) {
      truth.push_back({number / kNumberedRate, pose});
    }
    return truth;
  }
  int unmatched_color() const override { return unmatched_color_; }

 private:
  struct NumberedFrame {
    int number;
    std::string color_path;
    std::string depth_path;
  };

  std::vector<NumberedFrame> FindFrames() {
    const std::map<int, std::string> color = List(folder_, layout_.color);
    const std::map<int, std::string> depth = List(folder_, layout_.depth);
    if (color.empty()) {
      throw InputError(folder_ + ": has no colour images such as " +
                       Examples(layout_.color) + "; expected: " + layout_.what);
    }
    std::vector<NumberedFrame> frames;
    for (const auto& [number, path] : color) {
      const auto match = depth.find(number);
      if (match == depth.end()) {
        ++unmatched_color_;
      } else {
        frames.push_back({number, path, match->second});
      }
    }
    if (frames.empty()) {
      throw InputError(folder_ + ": none of its " +
                       std::to_string(color.size()) +
                       " colour images has a depth image " +
                       Examples(layout_.depth) + " of the same number");
    }
    return frames;
  }

  FrameAssembly MakeAssembly(const SourceOptions& options) const {
    std::optional<CameraSetup> own;
    if (!options.camera.has_value()) {
      own = layout_.camera(folder_, frames_.front().color_path,
                           frames_.front().depth_path);
    }
    SourceOptions said = options;
    if (own.has_value() && !own->depth_scale) {
      own->depth_scale = layout_.depth_scale;
    }
    if (said.camera.has_value() && !said.camera->depth_scale) {
      said.camera->depth_scale = layout_.depth_scale;
    }
    return FrameAssembly(ChooseCamera(said, own), options.keep_color);
  }

  const NumberedLayout& layout_;
  std::string folder_;
  int unmatched_color_ = 0;
  std::vector<NumberedFrame> frames_;
  FrameAssembly assembly_;
};

}  // namespace

bool IsNumbered(const NumberedLayout& layout, const std::string& folder) {
  return PathExists(fs::path(folder) / layout.mark) &&
         !List(folder, layout.color).empty() &&
         !List(folder, layout.depth).empty();
}

std::unique_ptr<FrameSource> OpenNumbered(const NumberedLayout& layout,
                                          const SourceOptions& options) {
  return std::make_unique<NumberedDataset>(layout, options);
}

}  // namespace rgbd_pose
