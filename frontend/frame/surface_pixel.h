#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/depth_noise.h"

namespace rgbd_pose {

// How far (m) the depths of neighbouring pixels of one surface are apart at
// most, at a depth (m): by noise and by slope.
double MaxSurfaceStep(double depth, const DepthNoiseModel& noise);

// Whether a pixel of a depth image (CV_16UC1), none of its border, lies on a
// surface with its neighbours, which are at most `max_step` raw units nearer or
// farther: at the edges of objects sensors report depths between the object and
// what is behind it.
bool IsOnSurface(const cv::Mat& depth, int x, int y, int max_step);

}  // namespace rgbd_pose
