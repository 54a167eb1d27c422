#pragma once

#include "core/estimation/frame_view.h"
#include "costs/assembly/packed_sum.h"
#include "costs/direct/direct_input.h"

// The pixels of the previous frame that direct costs look for in the current
// one, as columns.

namespace rgbd_pose {

// How the points of a level are chosen: the image is cut into square cells, as
// many as points are wanted, and each gives one point at most.
struct PointSelection {
  int max_points = 1;
  double min_gradient = 0.0;  // gray levels a pixel
  double min_depth = 0.0;     // m
  double max_depth = 0.0;
};

// The pixel of each cell where the image is steepest; none where it is flatter
// than min_gradient, or where the depth around has holes or edges. Columns:
// X (m), the sigma of its depth (m), its gray level.
void TexturedPoints(const FrameView& frame, int level,
                    const PointSelection& selection, PackedColumns* points);

// The middle of each cell, textured or not, if the surface around it is flat.
// Its depth is that of a plane through 5 x 5 measured ones, and so is less
// noisy than each of them. Columns: X (m), the plane N . X = 1 (1 / m), the
// sigma of a measured depth there (m).
void SmoothPoints(const FrameView& frame, const PointSelection& selection,
                  PackedColumns* points);

// How gray levels change from the previous frame to the current one, whose
// exposure is its own: sets input->gain and bias by robust regression over the
// textured points that are seen at input's motion. Weak
// priors (gain 1 +- 0.3, bias 0 +- 40 gray levels) decide where there is no
// texture to tell.
void EstimateBrightness(const PackedColumns& points, DirectInput* input);

}  // namespace rgbd_pose
