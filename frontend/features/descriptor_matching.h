#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A method to detect keypoints and to describe their surroundings.
struct DescriptorMethod {
  // Makes a detector of up to max_keypoints; descriptors are rows of bytes.
  cv::Ptr<cv::Feature2D> (*make)(int max_keypoints);

  // The distance between two descriptors of `size` bytes.
  double (*distance)(const uchar* a, const uchar* b, int size);

  // Descriptors with a larger distance show different places. The mean distance
  // of unrelated descriptors is about twice as large.
  double max_distance;

  // The size (px) of the smallest keypoints that the method finds, and the
  // standard deviation of their place (px). Larger keypoints come from a
  // correspondingly smaller image and are correspondingly less accurate.
  double base_size_px;
  double base_sigma_px;

  double SigmaPx(const cv::KeyPoint& keypoint) const {
    return base_sigma_px * std::max(1.0, keypoint.size / base_size_px);
  }
};

// ORB (Rublee et al., ICCV 2011), SIFT (Lowe, IJCV 2004) and AKAZE
// (Alcantarilla, Nuevo & Bartoli, BMVC 2013).
extern const DescriptorMethod kOrb, kSift, kAkaze;

// The keypoints of an image and their descriptors, one row each.
struct DescribedKeypoints {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;  // CV_8U

  DescribedKeypoints() = default;
  // Detects up to max_keypoints. AKAZE has no limit.
  DescribedKeypoints(const Frame& frame, const DescriptorMethod* method,
                     int max_keypoints);

  // Returns only the keypoints at the given indices.
  DescribedKeypoints Select(const std::vector<int>& places) const;
};

struct KeypointMatch {
  int reference = 0;
  int current = 0;
};

// Where to search for each reference keypoint (px). NaN: nowhere.
struct SearchGuide {
  std::vector<cv::Point2f> expected;
  float radius_px = 0.0F;
};

// Matches keypoints that are each other's nearest and clearly better than the
// second best at any other place (Lowe's ratio test), in the order of the
// reference. Only keypoints within the radius of the guide are used; null: all.
std::vector<KeypointMatch> MatchKeypoints(const DescriptorMethod& method,
                                          const DescribedKeypoints& reference,
                                          const DescribedKeypoints& current,
                                          const SearchGuide* guide);

}  // namespace rgbd_pose
