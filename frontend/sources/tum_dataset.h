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
  std::string color_path;    // of its file
  std::string depth_path;    // likewise
};

// The frames of a sequence in the layout of the TUM RGB-D benchmark, in strict
// time order; never empty.
struct TumLists {
  std::vector<ImagePair> pairs;  // never empty
  int unmatched_color = 0;       // colour images without a depth image
  int same_stamp = 0;  // images left out that have another one's stamp
};

// Both readers check columns and time stamps (in order; of one the first image
// is taken), and throw
// InputError (file:line) otherwise. Paths in the lists count from `folder`.

// Pairs rgb.txt and depth.txt of a folder by nearest time, at most
// `max_time_difference` (s) apart; see Associate.
TumLists ReadTumLists(const std::string& folder, double max_time_difference);

// Reads the pairs from lines `time colour_image time depth_image`, or depth
// first: in which order, the first line says by a path with the word depth in
// it or else by its images. How far the times are apart is not checked.
TumLists ReadTumAssociations(const std::string& folder,
                             const std::string& associations_file);

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
