#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_pose {

// A structured-light sensor (Kinect v1) as Khoshelham & Elberink (2012) fitted
// it: disparity counts eighths of a pixel, one eighth is kInverseDepthStep in
// inverse depth (1/m), and its noise has half an eighth as its sigma. In depth:
// sigma_z = 1.425e-3 z^2 and a step of 2.85e-3 z^2 (m).
constexpr double kInverseDepthStep = 2.85e-3;
constexpr double kDisparitySigma = 0.5;      // in eighths of a pixel
constexpr double kMinSensorDepth = 0.5;      // m, nothing is measured nearer
constexpr double kMaxSensorDepth = 8.0;      // m, nor farther
constexpr double kMaxSensorSlantDeg = 80.0;  // of a surface against the ray
constexpr double kColorSigma = 2.0;          // gray levels

// An exact depth image (CV_32FC1, m, 0 = none) in raw units (CV_16UC1,
// `depth_scale` a metre, 0 = none), rounded but otherwise untouched.
cv::Mat EncodeDepth(const cv::Mat& depth_m, double depth_scale);

// What the sensor makes of an exact depth image (CV_32FC1, m): noise and
// quantisation in disparity, no depth out of range, in the shadow of the
// projector (to the left of near things), at depth edges and on surfaces seen
// at a slant. `focal_px` is the focal length of the image. Noise is drawn for
// each pixel by itself (the real one is correlated over a few pixels) from
// `key` alone.
cv::Mat MeasureDepth(const cv::Mat& depth_m, double focal_px, uint64_t key);

// Adds white noise of kColorSigma to a CV_8UC3 image, drawn from `key` alone.
void AddColorNoise(uint64_t key, cv::Mat* color);

}  // namespace rgbd_pose
