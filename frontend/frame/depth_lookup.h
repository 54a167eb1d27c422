#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// The depth at a feature; depth 0 = none that can be trusted.
struct DepthSample {
  double depth = 0.0;  // m
  double sigma = 0.0;  // standard deviation, m
};

// Which depths are used, and how uncertain they are.
struct DepthLookupOptions {
  // Of single pixels.
  DepthNoiseModel noise = *FindDepthNoiseModel("khoshelham");

  double min_depth = 0.3;  // m
  double max_depth = 8.0;  // m
};

// The depth at an image point (px, distorted), never mixing two surfaces:
// inverse depth is linear over a plane's image, so a plane is fitted to the
// 3 x 3 neighbours' inverse depths and read at the point itself. Neighbours
// that do not lie on one surface (their spread exceeds the noise) give none. A
// neighbourhood with holes gives the nearest pixel's depth, if the others agree
// with it.
DepthSample LookUpDepth(const Frame& frame, double u, double v,
                        const DepthLookupOptions& options);

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
