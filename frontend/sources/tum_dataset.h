#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "frontend/sources/dataset.h"
#include "frontend/sources/source_options.h"
#include "frontend/sources/tum_lists.h"

namespace rgbd_pose {

// A sequence in the layout of the TUM RGB-D benchmark. A frame is a colour
// image and its depth image; its time stamp is that of the colour image.
class TumDataset : public Dataset {
 public:
  // Checks all that can be known without decoding the images: the lists, their
  // time stamps (strictly increasing) and that the images of all frames are
  // there. Throws InputError (file:line).
  explicit TumDataset(const SourceOptions& options);

  int size() const override { return static_cast<int>(lists_.pairs.size()); }
  double timestamp(int index) const override {
    return lists_.pairs[index].timestamp;
  }
  Frame Read(int index) const override;
  const RgbdCamera& camera() const override { return camera_; }

  // Of rgb.txt; 0 with an associations file.
  int unmatched_color() const override { return lists_.unmatched_color; }

 private:
  void CheckSize(const cv::Mat& image, const std::string& path) const;

  RgbdCamera camera_;
  bool keep_color_;
  TumLists lists_;
};

}  // namespace rgbd_pose
