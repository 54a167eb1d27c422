#pragma once

#include "core/estimation/frame_view.h"
#include "costs/assembly/packed_sum.h"
#include "costs/direct/direct_input.h"

// Selects the pixels of the previous frame that direct costs look for in the
// current frame, and stores them as columns.

namespace rgbd_pose {

// How the points of a level are selected: the image is divided into about as
// many square cells as there should be points; each cell gives at most one.
struct PointSelection {
  int max_points = 1;
  double min_gradient = 0.0;  // gray levels per pixel
  double min_depth = 0.0;     // m
  double max_depth = 0.0;
};

// The pixel of each cell with the largest gradient. A cell gives none if its
// gradients are below min_gradient, or if the depth around that pixel has holes
// or edges. Columns: X (m), sigma of its depth (m), its gray level.
void TexturedPoints(const FrameView& frame, int level,
                    const PointSelection& selection, PackedColumns* points);

// The centre of each cell, textured or not, if the surface around it is flat.
// Its depth comes from a plane through 5 x 5 measured depths and is less noisy
// than each of them. Columns: X (m), the plane N . X = 1 (1 / m), the sigma of
// a single measured depth there (m).
void SmoothPoints(const FrameView& frame, const PointSelection& selection,
                  PackedColumns* points);

// Estimates how gray levels change between the frames, which have separate
// exposures: sets input->gain and bias by robust regression over the textured
// points that are visible at input's motion. Weak priors (gain 1 +- 0.3,
// bias 0 +- 40 gray levels) decide where there is no texture.
void EstimateBrightness(const PackedColumns& points, DirectInput* input);

}  // namespace rgbd_pose
