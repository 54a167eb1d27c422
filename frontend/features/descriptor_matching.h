#pragma once

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string_view>
#include <vector>

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
extern const DescriptorMethod kOrb;

// Blobs in scale space, histograms of gradients (Lowe, IJCV 2004).
extern const DescriptorMethod kSift;

// Blobs in a nonlinear scale space, binary tests of gradients (Alcantarilla,
// Nuevo & Bartoli, BMVC 2013).
extern const DescriptorMethod kAkaze;

// Keypoints of an image with their descriptors, a row each.
struct DescribedKeypoints {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;  // CV_8U

  const uchar* descriptor(size_t i) const {
    return descriptors.ptr(static_cast<int>(i));
  }
  // Those at the given places only.
  DescribedKeypoints Select(const std::vector<int>& places) const;
};

struct KeypointMatch {
  int reference = 0;
  int current = 0;
};

// Where to look for each reference keypoint (px). NaN: nowhere.
struct SearchGuide {
  std::vector<cv::Point2f> expected;
  float radius_px = 0.0F;
};

// Keypoints that are each other's nearest in both directions, with a clearly
// worse second best (Lowe's ratio test) at any other place, in the order of the
// reference. A guide leaves only what lies within its radius; null: everything.
std::vector<KeypointMatch> MatchKeypoints(const DescriptorMethod& method,
                                          const DescribedKeypoints& reference,
                                          const DescribedKeypoints& current,
                                          const SearchGuide* guide);

}  // namespace rgbd_pose
