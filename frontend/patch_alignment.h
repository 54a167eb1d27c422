#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "frontend/patch.h"

namespace rgbd_pose {

struct PatchAlignmentOptions {
  int max_iterations = 8;

  // A step shorter than this (px) is the last.
  float min_step_px = 0.02F;

  // The result lies at most this far (px, each way) from the start.
  float max_shift_px = 4.0F;
};

// Where a patch was found in an image.
struct AlignedPatch {
  bool found = false;  // false: left the image or the allowed shift, or
                       // shows nothing like the patch
  float u = 0.0F;      // px
  float v = 0.0F;
  float gain = 1.0F;  // of the image's contrast over the patch's

  // Correlation of patch and image, gain and bias taken out: 1 = the same.
  float correlation = 0.0F;

  // RMS of what the patch does not explain, in grey levels of the patch.
  float residual = 0.0F;
};

// Moves a patch over an image (CV_8UC1), from a start (px), to where it fits
// best, whatever the gain and bias between them. On an edge or a flat place it
// is not found.
template <int N>
AlignedPatch AlignPatch(const Patch<N>& patch, const cv::Mat& image,
                        float start_u, float start_v,
                        const PatchAlignmentOptions& options);

}  // namespace rgbd_pose
