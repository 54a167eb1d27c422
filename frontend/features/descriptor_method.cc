#include "frontend/features/descriptor_method.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/hal.hpp>

namespace rgbd_pose {
namespace {

double HammingDistance(const uchar* a, const uchar* b, int size) {
  return cv::hal::normHamming(a, b, size);
}

double EuclideanDistance(const uchar* a, const uchar* b, int size) {
  int sum = 0;
  for (int i = 0; i < size; ++i) {
    const int difference = a[i] - b[i];
    sum += difference * difference;
  }
  return std::sqrt(static_cast<double>(sum));
}

cv::Ptr<cv::Feature2D> MakeOrb(int max_keypoints) {
  constexpr float kScale = 1.2F;
  constexpr int kLevels = 8;
  constexpr int kPatchPx = 31;
  // Lower than OpenCV's 20, for dark or blurred frames; the strongest are kept.
  constexpr int kFastThreshold = 10;
  return cv::ORB::create(max_keypoints, kScale, kLevels, kPatchPx, 0, 2,
                         cv::ORB::HARRIS_SCORE, kPatchPx, kFastThreshold);
}

cv::Ptr<cv::Feature2D> MakeSift(int max_keypoints) {
  constexpr int kLayers = 3;
  constexpr double kContrast = 0.04;
  constexpr double kEdge = 10.0;
  constexpr double kSigma = 1.6;
  return cv::SIFT::create(max_keypoints, kLayers, kContrast, kEdge, kSigma,
                          CV_8U);
}

// Has no limit on the number of keypoints.
cv::Ptr<cv::Feature2D> MakeAkaze(int /*max_keypoints*/) {
  constexpr int kFullSize = 0;
  constexpr int kChannels = 3;
  // Half of OpenCV's, for dark or blurred frames.
  constexpr float kThreshold = 0.0005F;
  // One fewer each than OpenCV's: two thirds of the time, as good a path.
  constexpr int kOctaves = 3;
  constexpr int kLayers = 3;
  return cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, kFullSize, kChannels,
                           kThreshold, kOctaves, kLayers);
}

}  // namespace

double DescriptorMethod::SigmaPx(const cv::KeyPoint& keypoint) const {
  return base_sigma_px * std::max(1.0, keypoint.size / base_size_px);
}

const DescriptorMethod& Orb() {
  constexpr double kMaxDistance = 64.0;  // of 256 bits 128 differ by chance
  constexpr double kSizePx = 31.0;
  constexpr double kSigmaPx = 0.7;  // whole pixels
  static const DescriptorMethod kMethod = {
      "orb", MakeOrb, HammingDistance, kMaxDistance, kSizePx, kSigmaPx};
  return kMethod;
}

const DescriptorMethod& Sift() {
  constexpr double kMaxDistance = 250.0;  // vectors of length 512
  constexpr double kSizePx = 1.8;
  constexpr double kSigmaPx = 0.5;
  static const DescriptorMethod kMethod = {
      "sift", MakeSift, EuclideanDistance, kMaxDistance, kSizePx, kSigmaPx};
  return kMethod;
}

const DescriptorMethod& Akaze() {
  constexpr double kMaxDistance = 121.0;  // of 486 bits 243 differ by chance
  constexpr double kSizePx = 4.8;
  constexpr double kSigmaPx = 0.5;
  static const DescriptorMethod kMethod = {
      "akaze", MakeAkaze, HammingDistance, kMaxDistance, kSizePx, kSigmaPx};
  return kMethod;
}

}  // namespace rgbd_pose
