#pragma once

#include <string>
#include <vector>

#include "frontend/sources/dataset.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/source_options.h"
#include "frontend/sources/tum_lists.h"

namespace rgbd_pose {

// A sequence in the layout of the TUM RGB-D benchmark. A frame is a colour
// image and its depth image; its time stamp is that of the colour image.
// Its own camera is camera.yaml, as rgbd_simulate writes it, or calibration.txt
// (fx fy cx cy), as ETH3D does.
class TumDataset : public Dataset {
 public:
  // Checks the lists and their time stamps. Throws
  // InputError (file:line).
  explicit TumDataset(const SourceOptions& options);

  int size() const override { return static_cast<int>(lists_.pairs.size()); }
  double timestamp(int index) const override {
    return lists_.pairs[index].timestamp;
  }
  Frame Read(int index) const override;
  const RgbdCamera& camera() const override { return assembly_.camera(); }

  // Of groundtruth.txt, if it is there.
  Trajectory ground_truth() const override;

  // Of rgb.txt; 0 with an associations file.
  int unmatched_color() const override { return lists_.unmatched_color; }

  // Of images and, once it was asked for, of the true path.
  std::vector<std::string> remarks() const override;

 private:
  std::string folder_;
  TumLists lists_;
  mutable std::vector<std::string> truth_remarks_;
  FrameAssembly assembly_;
};

}  // namespace rgbd_pose
