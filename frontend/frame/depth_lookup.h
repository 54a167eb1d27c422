#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// The depth at a feature; 0 means no reliable depth.
struct DepthSample {
  double depth = 0.0;  // m
  double sigma = 0.0;  // standard deviation, m
};

// Which depths are used, and how uncertain they are.
struct DepthLookupOptions {
  // Noise of single pixels.
  DepthNoiseModel noise = *FindDepthNoiseModel("khoshelham");

  double min_depth = 0.3;  // m
  double max_depth = 8.0;  // m
};

// The depth at an image point (px, distorted), never a mix of two surfaces. As
// the inverse depth of a plane is linear in the image, a plane is fitted to the
// inverse depths of the 3 x 3 neighbours and evaluated at the point. There is
// no depth if the neighbours are not on one surface (their spread exceeds the
// noise). With holes in the neighbourhood the result is the depth of the
// nearest pixel, if the other pixels agree with it.
DepthSample LookUpDepth(const Frame& frame, double u, double v,
                        const DepthLookupOptions& options);

// Unit normal (camera axes, towards the camera) of the surface seen at an image
// point (px). A plane is fitted to the inverse depths of 3 x 3 pixels; they are
// several pixels apart, as a longer baseline reduces the effect of depth noise.
// Zero if a depth is missing or if the nine points are not on one plane (an
// edge between two surfaces). `place`: the image point on the plane z = 1,
// without distortion.
Eigen::Vector3d LookUpNormal(const Frame& frame, const Camera& camera, double u,
                             double v, const Eigen::Vector2d& place);

// The largest difference (m) between the depths of neighbouring pixels on one
// surface at a depth (m), caused by noise and slope.
double MaxSurfaceStep(double depth, const DepthNoiseModel& noise);

// Whether a pixel of a depth image (CV_16UC1), not at its border, is on a
// surface with its neighbours: at least two of four have a depth, and all of
// them are at most `max_step` raw units nearer or farther. At the edges of
// objects sensors report depths between the object and the background.
bool IsOnSurface(const cv::Mat& depth, int x, int y, int max_step);

// A warning of one line if the median depth of a frame is implausible for an
// RGB-D camera (below 0.2 m or above 20 m), as caused by a wrong depth scale.
// Empty if it is plausible or if the frame has no depth. Small errors are not
// detected: a scale that is wrong by a factor of 5 still gives plausible rooms.
std::string DepthScaleWarning(const Frame& frame);

}  // namespace rgbd_pose
