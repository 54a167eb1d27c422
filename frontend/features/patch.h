#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Side of a patch. Larger ones (16) scatter less from frame to frame, but reach
// over the edges of their surface: in simulation they drift half as much again,
// and they take longer.
constexpr int kPatchSize = 8;

// What inverse-compositional Lucas-Kanade (Baker & Matthews 2004) needs to know
// of a patch T, rows after each other. An image patch I that shows it brighter
// and moved by d px, I(x) = gain T(x + d) + bias, has
//   gain = <contrast, I>,   d = (<steps_x, I>, <steps_y, I>) / gain
// to first order. The steps are orthogonal to 1 and to T, so that gain and bias
// need no iteration of their own.
struct Patch {
  static constexpr int kPixels = kPatchSize * kPatchSize;

  alignas(32) float contrast[kPixels];
  alignas(32) float steps_x[kPixels];
  alignas(32) float steps_y[kPixels];

  // Sum of the squared deviations of T from its mean.
  float energy = 0.0F;

  // The smaller eigenvalue of the Hessian of d (grey^2 / px^2): noise of s grey
  // levels moves the result by s / sqrt(min_eigenvalue) px. 0: there is too
  // little to hold on to, and nothing else is set.
  float min_eigenvalue = 0.0F;
};

// The patch around a point (px of `image`, CV_8UC1), seen through an affine
// map: its pixel (i, j), -4 <= i, j < 4, shows image(centre + image_from_patch
// * (i, j)). Beyond its border the image goes on as it is there.
void MakePatch(const cv::Mat& image, const Eigen::Vector2f& centre,
               const Eigen::Matrix2f& image_from_patch, Patch* patch);

// How the image around an observation (with a depth) is stretched and turned
// by a motion: d(pixel in cur) / d(pixel in ref) over the plane of its depth
// and normal, or parallel to the image if there is no normal or it is seen
// edge-on. The point must lie before both cameras.
Eigen::Matrix2f PlaneWarp(const Camera& camera, const Observation& ref,
                          const Rigid3d& cur_from_ref);

struct PatchAlignmentOptions {
  int max_iterations = 8;

  // A step shorter than this (px) is the last.
  float min_step_px = 0.02F;

  // The result lies at most this far (px, along each axis) from the start:
  // beyond it the patch and its start have too little in common.
  float max_shift_px = 3.0F;
};

// Where a patch was found in an image.
struct AlignedPatch {
  // False, and nothing else is set: the patch has too little contrast, it left
  // the image or the allowed shift, or there is nothing like it.
  bool found = false;

  float u = 0.0F;     // px
  float v = 0.0F;     // px
  float gain = 0.0F;  // contrast of the image over that of the patch

  // Of patch and image, whatever the gain and bias: 1 = the same.
  float correlation = 0.0F;

  // RMS of what the patch does not explain, in its own grey levels.
  float residual = 0.0F;
};

// Moves a patch over an image (CV_8UC1), from a start (px), to where it fits
// best with any gain and bias.
AlignedPatch AlignPatch(const Patch& patch, const cv::Mat& image, float start_u,
                        float start_v, const PatchAlignmentOptions& options);

}  // namespace rgbd_pose
