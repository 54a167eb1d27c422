#pragma once

#include <string>
#include <vector>

#include "frontend/sources/dataset.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// A colour image and its depth image.
struct ImagePair {
  double timestamp = 0.0;    // of the colour image, s
  double depth_delay = 0.0;  // of the depth image, s after it
  std::string color_path;    // file of the colour image
  std::string depth_path;    // file of the depth image
};

// The image lists of a sequence in the layout of the TUM RGB-D benchmark.
struct TumLists {
  std::vector<ImagePair> pairs;  // in strict time order; never empty
  int unmatched_color = 0;       // colour images without a depth image
  int same_stamp = 0;  // images left out for having the stamp of another
};

// Both readers throw InputError (file:line) for wrong columns and for
// decreasing time stamps. Of images with equal stamps, the first one is used.
// Paths in the lists are relative to `folder`.

// Pairs rgb.txt and depth.txt of a folder by nearest time, at most
// `max_time_difference` (s) apart; see Associate.
TumLists ReadTumLists(const std::string& folder, double max_time_difference);

// Reads pairs from lines `time colour_image time depth_image`, or depth first.
// The first line decides the order: by a path that contains the word depth, or
// else by its images. The time differences are not checked.
TumLists ReadTumAssociations(const std::string& folder,
                             const std::string& associations_file);

// A sequence in the layout of the TUM RGB-D benchmark. A frame is a colour
// image and its depth image and has the time stamp of the colour image. Its own
// camera is in camera.yaml, as written by rgbd_simulate, or in calibration.txt
// (fx fy cx cy), as in ETH3D.
class TumDataset : public Dataset {
 public:
  // Throws InputError (file:line) if the lists are invalid.
  explicit TumDataset(const SourceOptions& options);

  int size() const override { return static_cast<int>(lists_.pairs.size()); }
  double timestamp(int index) const override {
    return lists_.pairs[index].timestamp;
  }
  Frame Read(int index) const override;
  const RgbdCamera& camera() const override { return assembly_.camera(); }

  // From groundtruth.txt, if it exists.
  Trajectory ground_truth() const override;

  // Images of rgb.txt; 0 with an associations file.
  int unmatched_color() const override { return lists_.unmatched_color; }

  // On images and, after a call of ground_truth, on the true path.
  std::vector<std::string> remarks() const override;

 private:
  std::string folder_;
  TumLists lists_;
  mutable std::vector<std::string> truth_remarks_;
  FrameAssembly assembly_;
};

}  // namespace rgbd_pose
