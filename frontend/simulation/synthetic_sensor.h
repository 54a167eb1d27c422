#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>

#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_renderer.h"

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

// How long a camera gathers light, and how much its image is amplified.
struct Exposure {
  double shutter_s = 0.0;  // 0: the image of an instant
  double gain = 1.0;
  double readout_s = 0.0;  // see Shutter
};

// The gain at time t (s) of an automatic exposure that swings slowly around 1:
// exp(amplitude * sin(2 pi t / kExposurePeriod)).
constexpr double kExposurePeriod = 4.0;  // s
double DriftingGain(double amplitude, double t);

// What a camera on a path world_from_cam(t) sees at time t. Colour is the mean
// of an odd number of renderings, evenly spread over the shutter time with t in
// its middle and never much more than kMaxBlurStep apart in the image, times
// the gain, rounded once and cut off at 255. Depth is that of time t. Gray
// levels are taken as proportional to light. With a rolling shutter t is the
// time of the middle row, of both images, and each band of rows (see Renderer)
// is seen at the time of its own middle.
constexpr double kMaxBlurStep = 2.0;  // px; finer than that the lens blurs
Rendering Expose(const Renderer& renderer, double focal_px,
                 const std::function<Rigid3d(double t)>& world_from_cam,
                 double t, const Exposure& exposure);

}  // namespace rgbd_pose
