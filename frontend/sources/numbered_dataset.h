#pragma once

#include <string>
#include <vector>

#include "frontend/sources/dataset.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// A recording in numbered files, in one of the NumberedLayouts. A frame is a
// colour and a depth image of the same number; its time stamp is that number
// over the layout's rate.
class NumberedDataset : public Dataset {
 public:
  // Throws InputError if there are no such files, or they do not say what
  // camera it was and the options do not, either.
  NumberedDataset(const NumberedLayout& layout, const SourceOptions& options);

  // Whether a folder has images and the mark of this layout.
  static bool Recognises(const NumberedLayout& layout,
                         const std::string& folder);

  int size() const override { return static_cast<int>(frames_.size()); }
  double timestamp(int index) const override {
    return frames_[index].number / kNumberedRate;
  }
  Frame Read(int index) const override;
  const RgbdCamera& camera() const override { return assembly_.camera(); }
  Trajectory ground_truth() const override;

  // Colour images whose number no depth image has.
  int unmatched_color() const override { return unmatched_color_; }

 private:
  struct NumberedFrame {
    int number;
    std::string color_path;
    std::string depth_path;
  };

  std::vector<NumberedFrame> FindFrames();
  FrameAssembly MakeAssembly(const SourceOptions& options) const;

  const NumberedLayout& layout_;
  std::string folder_;
  int unmatched_color_ = 0;
  std::vector<NumberedFrame> frames_;
  FrameAssembly assembly_;
};

}  // namespace rgbd_pose
