#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Side of a patch, px. Larger ones extend beyond the edges of their surface: 16
// px drift 50 % more in simulation, and take longer.
constexpr int kPatchSize = 8;

// What inverse-compositional Lucas-Kanade (Baker & Matthews 2004) needs to know
// about a patch T, stored row by row. For an image patch I with another
// brightness and a shift of d px, I(x) = gain T(x + d) + bias, to first order
//   gain = <contrast, I>,   d = (<steps_x, I>, <steps_y, I>) / gain.
// The steps are orthogonal to 1 and to T: gain and bias need no iteration of
// their own.
struct Patch {
  static constexpr int kPixels = kPatchSize * kPatchSize;

  alignas(32) float contrast[kPixels];
  alignas(32) float steps_x[kPixels];
  alignas(32) float steps_y[kPixels];

  // Sum of the squared deviations of T from its mean.
  float energy = 0.0F;

  // The smaller eigenvalue of the Hessian of d (grey^2 / px^2): noise of s grey
  // levels moves the result by s / sqrt(min_eigenvalue) px. 0: the patch has
  // too little contrast, and no other member is valid.
  float min_eigenvalue = 0.0F;
};

// Makes the patch around a point (px of `image`, CV_8UC1), seen through an
// affine map: its pixel (i, j), -4 <= i, j < 4, shows image(centre +
// image_from_patch * (i, j)). The image is continued with its border values.
void MakePatch(const cv::Mat& image, const Eigen::Vector2f& centre,
               const Eigen::Matrix2f& image_from_patch, Patch* patch);

// Returns how a motion stretches and turns the image around an observation with
// depth: d(pixel in cur) / d(pixel in ref) over the plane of its depth and
// normal. Without a normal, or if the plane is seen edge-on, the plane is
// parallel to the image. The point must lie in front of both cameras.
Eigen::Matrix2f PlaneWarp(const Camera& camera, const Observation& ref,
                          const Rigid3d& cur_from_ref);

// Where a patch was found in an image.
struct AlignedPatch {
  // False if the patch has too little contrast, left the image or the allowed
  // shift, or does not match the image. The other members are then not set.
  bool found = false;

  float u = 0.0F;  // px
  float v = 0.0F;  // px

  // Of patch and image, for any gain and bias: 1 = the same.
  float correlation = 0.0F;

  // RMS of what the patch does not explain, in grey levels of the patch.
  float residual = 0.0F;
};

// Moves a patch over an image (CV_8UC1) from a start (px) to the place within
// 3 px along each axis where it fits best with any gain and bias. Iterations
// stop after a step shorter than `min_step_px`.
AlignedPatch AlignPatch(const Patch& patch, const cv::Mat& image, float start_u,
                        float start_v, float min_step_px);

}  // namespace rgbd_pose
