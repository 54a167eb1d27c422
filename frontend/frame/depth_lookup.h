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
  // Noise of single pixels; the default is that of an unknown camera.
  DepthNoiseModel noise = *FindNamed(DepthNoiseModels(), "khoshelham");

  double min_depth = 0.3;  // m
  double max_depth = 8.0;  // m

  // Returns one line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The depth at an image point (px, distorted), never a mix of two surfaces. As
// the inverse depth of a plane is linear in the image, a plane is fitted to the
// inverse depths of the 3 x 3 neighbours, of which two may be missing, and
// evaluated at the point. With three missing it is the depth of the nearest
// pixel. There is none if more are missing, if that pixel has none, or if the
// spread exceeds the noise.
DepthSample LookUpDepth(const Frame& frame, double u, double v,
                        const DepthLookupOptions& options);

// Unit normal (camera axes, towards the camera) of the surface seen at an image
// point (px): a plane is fitted to the inverse depths of 3 x 3 pixels, several
// pixels apart to reduce the effect of depth noise. Zero if more than two
// depths are missing or if the points are not on one plane. `place`: the image
// point on the plane z = 1, without distortion.
Eigen::Vector3d LookUpNormal(const Frame& frame, const Camera& camera, double u,
                             double v, const Eigen::Vector2d& place);

// The largest step (m) of depth to a neighbour on one surface at a depth (m).
double MaxSurfaceStep(double depth, const DepthNoiseModel& noise);

// Whether a pixel of a depth image (CV_16UC1), not at its border, is on a
// surface with its neighbours: at least two of four have a depth, and all of
// them are at most `max_step` raw units nearer or farther. At the edges of
// objects sensors report depths between the object and the background.
bool IsOnSurface(const cv::Mat& depth, int x, int y, int max_step);

// A warning of one line if the median depth of a frame is implausible for an
// RGB-D camera, as caused by a wrong depth scale: above 20 m, or below 0.3 m,
// where depths are not used by default. Otherwise empty, also if the frame has
// no depth.
std::string DepthScaleWarning(const Frame& frame);

}  // namespace rgbd_pose
