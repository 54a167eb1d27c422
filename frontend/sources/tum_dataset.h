#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "frontend/sources/dataset.h"
#include "frontend/sources/tum_lists.h"

namespace rgbd_pose {

// Where a sequence is, and how to read it.
struct TumDatasetOptions {
  // Holds rgb.txt, depth.txt (unless there is an associations file) and the
  // images, whose paths in the lists count from here.
  std::string folder;
  // Lines `time colour_image time depth_image`, or depth first; taken as they
  // are. Empty: associate rgb.txt with depth.txt.
  std::string associations_file;
  RgbdCamera camera;
  // Seconds between a colour image and its depth image, at most.
  double max_time_difference = 0.02;
};

// A sequence in the layout of the TUM RGB-D benchmark. A frame is a colour
// image and its depth image; its time stamp is that of the colour image.
class TumDataset : public Dataset {
 public:
  // Checks all that can be known without decoding the images: the lists, their
  // time stamps (strictly increasing) and that the images of all frames are
  // there. Throws InputError (file:line).
  explicit TumDataset(const TumDatasetOptions& options);

  int size() const override { return static_cast<int>(lists_.pairs.size()); }
  double timestamp(int index) const override {
    return lists_.pairs[index].timestamp;
  }
  Frame Read(int index) const override;
  const RgbdCamera& camera() const override { return camera_; }

  // The colour image of a frame, CV_8UC3 in the order blue, green, red. Throws
  // as Read does.
  cv::Mat ReadColor(int index) const;

  // How many images of rgb.txt make no frame since they have no depth image; 0
  // with an associations file.
  int unmatched_color() const { return lists_.unmatched_color; }

 private:
  void CheckSize(const cv::Mat& image, const std::string& path) const;

  RgbdCamera camera_;
  TumLists lists_;
};

}  // namespace rgbd_pose
