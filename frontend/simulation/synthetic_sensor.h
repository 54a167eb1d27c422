#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>

#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_renderer.h"

namespace rgbd_pose {

// A structured-light sensor (Kinect v1) as fitted by Khoshelham & Elberink
// (2012). Disparity is measured in eighths of a pixel; an eighth is
// kInverseDepthStep in inverse depth (1/m). The sigma of the noise is half an
// eighth. In depth: sigma_z = 1.425e-3 z^2 and a step of 2.85e-3 z^2 (m).
constexpr double kInverseDepthStep = 2.85e-3;
constexpr double kDisparitySigma = 0.5;      // in eighths of a pixel
constexpr double kMinSensorDepth = 0.5;      // m, nothing nearer is measured
constexpr double kMaxSensorDepth = 8.0;      // m, nothing farther either
constexpr double kMaxSensorSlantDeg = 80.0;  // between normal and ray
constexpr double kColorSigma = 2.0;          // grey levels

// Converts an exact depth image (CV_32FC1, m, 0 = none) to raw units (CV_16UC1,
// `depth_scale` per metre, 0 = none). It is only rounded.
cv::Mat EncodeDepth(const cv::Mat& depth_m, double depth_scale);

// Simulates the sensor for an exact depth image (CV_32FC1, m): noise and
// quantisation in disparity, no depth out of range, in the shadow of the
// projector (left of near objects), at depth edges and on steeply slanted
// surfaces. `focal_px`: of the image. The noise is drawn from `key` alone, for
// each pixel independently (in a real sensor it is correlated over a few).
cv::Mat MeasureDepth(const cv::Mat& depth_m, double focal_px, uint64_t key);

// Adds white noise of kColorSigma to a CV_8UC3 image, drawn from `key` alone.
void AddColorNoise(uint64_t key, cv::Mat* color);

// Exposure time, gain and readout of a camera.
struct Exposure {
  double shutter_s = 0.0;  // 0: instantaneous
  double gain = 1.0;
  double readout_s = 0.0;  // see Shutter
};

// The gain at time t (s) of an automatic exposure that varies slowly around 1:
// exp(amplitude * sin(2 pi t / kExposurePeriod)).
constexpr double kExposurePeriod = 4.0;  // s
double DriftingGain(double amplitude, double t);

// What a camera on a path world_from_cam(t) sees at time t; with a rolling
// shutter, the time of the middle row (see Renderer). Colour is the mean of an
// odd number of renderings, evenly spread over the exposure time around t and
// at most about kMaxBlurStep apart in the image, times the gain, clipped at
// 255: grey levels are proportional to light. Depth is not mixed.
constexpr double kMaxBlurStep = 2.0;  // px; finer steps are blurred by the lens
Rendering Expose(const Renderer& renderer, double focal_px,
                 const std::function<Rigid3d(double t)>& world_from_cam,
                 double t, const Exposure& exposure);

}  // namespace rgbd_pose
