#pragma once

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string_view>

namespace rgbd_pose {

// A way to detect keypoints and to describe what is around them.
struct DescriptorMethod {
  std::string_view name;

  // Detects up to max_keypoints; descriptors are rows of bytes.
  cv::Ptr<cv::Feature2D> (*make)(int max_keypoints);

  // The distance between two descriptors of `size` bytes.
  double (*distance)(const uchar* a, const uchar* b, int size);

  // Descriptors further apart show different things. Unrelated ones are about
  // twice as far apart on average.
  double max_distance;

  // The size (px) of the smallest keypoints it finds, and how exactly it
  // places them (standard deviation, px). Greater ones come from an image that
  // is as much smaller, and are as much less exact.
  double base_size_px;
  double base_sigma_px;

  double SigmaPx(const cv::KeyPoint& keypoint) const;
};

// Oriented FAST corners, rotated binary tests (Rublee et al., ICCV 2011).
const DescriptorMethod& Orb();

// Blobs in scale space, histograms of gradients (Lowe, IJCV 2004).
const DescriptorMethod& Sift();

// Blobs in a nonlinear scale space, binary tests of gradients (Alcantarilla,
// Nuevo & Bartoli, BMVC 2013).
const DescriptorMethod& Akaze();

}  // namespace rgbd_pose
