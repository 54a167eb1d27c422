#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/descriptor_method.h"

namespace rgbd_pose {

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
