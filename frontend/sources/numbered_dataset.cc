#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/image_pairing.h"
#include "frontend/sources/masks.h"
#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/numbered_paths.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// "color/123.jpg or rgb/123.png"
std::string Examples(std::vector<std::string> choices) {
  for (std::string& file : choices) file.replace(file.find('*'), 1, "123");
  return Join(choices, " or ");
}

class NumberedDataset final : public Dataset {
 public:
  NumberedDataset(const NumberedLayout& layout, const SourceOptions& options)
      : layout_(layout),
        folder_(FindFrames(options.path)),
        times_(FindTimes()),
        assembly_(ChooseSetup(options), options.keep_color) {}

  int size() const override { return static_cast<int>(folder_.frames.size()); }
  double timestamp(int index) const override { return times_[index]; }
  Frame Read(int index) const override {
    const NumberedFrame& files = folder_.frames[index];
    return assembly_.Read({index, timestamp(index)}, files.color_path,
                          files.depth_path);
  }
  const RgbdCamera& camera() const override { return assembly_.camera(); }
  Trajectory ground_truth() const override {
    Trajectory truth;
    const NumberedPoses poses = layout_.poses(folder_);
    for (int i = 0; i < size(); ++i) {
      const auto pose = poses.find(folder_.frames[i].number);
      if (pose != poses.end()) truth.push_back({timestamp(i), pose->second});
    }
    return truth;
  }
  std::vector<std::string> remarks() const override {
    std::vector<std::string> lines;
    if (!has_times_) {
      lines.push_back(folder_.path.string() +
                      Format(": has no timestamps.txt: %g frames per second "
                             "are assumed",
                             kNumberedRate));
    }
    if (is_preset_) {
      lines.push_back(folder_.path.string() +
                      ": has no calibration; that of the preset " +
                      layout_.preset + " is taken");
    }
    std::vector<std::string> colors;
    for (const auto& frame : folder_.frames) colors.push_back(frame.color_path);
    for (const std::string& line :
         {IntervalRemark(folder_.path.string(), times_), MaskRemark(colors)}) {
      if (!line.empty()) lines.push_back(line);
    }
    return lines;
  }
  int unmatched_color() const override {
    return static_cast<int>(folder_.numbers.size() - folder_.frames.size());
  }

 private:
  NumberedFolder FindFrames(const std::string& folder) const {
    const auto color = NumberedPaths(folder, layout_.color);
    const auto depth = NumberedPaths(folder, layout_.depth);
    if (color.empty()) {
      throw InputError(folder + ": has no colour images such as " +
                       Examples(layout_.color) + "; expected: " + layout_.what);
    }
    NumberedFolder found;
    found.path = folder;
    for (const auto& [number, path] : color) {
      found.numbers.push_back(number);
      const auto match = depth.find(number);
      if (match == depth.end()) continue;
      found.frames.push_back({number, path, match->second});
    }
    if (found.frames.empty()) {
      throw InputError(folder + ": none of its " +
                       std::to_string(color.size()) +
                       " colour images has a depth image " +
                       Examples(layout_.depth) + " of the same number");
    }
    return found;
  }

  // The times of all frames, s.
  std::vector<double> FindTimes() {
    const std::vector<double> of_images = NumberedTimes(folder_);
    has_times_ = !of_images.empty();
    std::vector<double> times;
    for (const NumberedFrame& frame : folder_.frames) {
      const auto place = std::lower_bound(folder_.numbers.begin(),
                                          folder_.numbers.end(), frame.number);
      times.push_back(has_times_ ? of_images[place - folder_.numbers.begin()]
                                 : frame.number / kNumberedRate);
    }
    return times;
  }

  CameraSetup ChooseSetup(const SourceOptions& options) {
    const std::optional<RgbdCamera> preset = CameraPreset(layout_.preset);
    std::optional<CameraSetup> own;
    if (!options.camera.has_value()) {
      own = NumberedCamera(layout_, folder_);
      is_preset_ = !own.has_value() && preset.has_value();
      if (is_preset_) own = CameraSetup(*preset);
    }
    CameraSetup setup = ChooseCamera(options, own);
    if (!setup.depth_scale) setup.depth_scale = layout_.depth_scale;
    if (preset.has_value() && !setup.color_shutter.is_known) {
      setup.color_shutter = preset->color_shutter;
      setup.depth_shutter = preset->depth_shutter;
    }
    return setup;
  }

  const NumberedLayout& layout_;
  NumberedFolder folder_;
  bool has_times_ = false;     // else 30 frames per second are assumed
  std::vector<double> times_;  // of the frames, s
  bool is_preset_ = false;     // the camera is that of the layout
  FrameAssembly assembly_;
};

}  // namespace

bool HasNumberedColor(const NumberedLayout& layout, const std::string& folder) {
  return PathExists(fs::path(folder) / layout.mark) &&
         !NumberedPaths(folder, layout.color).empty();
}

bool IsNumbered(const NumberedLayout& layout, const std::string& folder) {
  return HasNumberedColor(layout, folder) &&
         !NumberedPaths(folder, layout.depth).empty();
}

std::unique_ptr<FrameSource> OpenNumbered(const NumberedLayout& layout,
                                          const SourceOptions& options) {
  return std::make_unique<NumberedDataset>(layout, options);
}

}  // namespace rgbd_pose
