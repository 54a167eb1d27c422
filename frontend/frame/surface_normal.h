#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Unit normal (camera axes, towards the camera) of the surface seen at an image
// point (px), or zero where there is none: a plane fitted to the inverse depths
// of 3 x 3 pixels several pixels apart, so that the baseline is long against
// the noise of depth. None if a depth is missing or the nine do not lie on one
// plane (an edge between two surfaces). `place`: of the image point on the
// plane z = 1, without distortion.
Eigen::Vector3d LookUpNormal(const Frame& frame, const Camera& camera, double u,
                             double v, const Eigen::Vector2d& place);

// How far (m) the depths of neighbouring pixels of one surface are apart at
// most, at a depth (m): by noise and by slope.
double MaxSurfaceStep(double depth, const DepthNoiseModel& noise);

// Whether a pixel of a depth image (CV_16UC1), none of its border, lies on a
// surface with its neighbours, which are at most `max_step` raw units nearer or
// farther: at the edges of objects sensors report depths between the object and
// what is behind it.
bool IsOnSurface(const cv::Mat& depth, int x, int y, int max_step);

}  // namespace rgbd_pose
