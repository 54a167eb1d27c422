#pragma once

#include <opencv2/core.hpp>

#include "frontend/features/patch.h"

namespace rgbd_pose {

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
