#pragma once

#include <Eigen/Core>
#include <string>

#include "core/estimation/frame_view.h"
#include "costs/assembly/packed_sum.h"
#include "costs/direct/direct_options.h"

// The pixels of the previous frame that direct costs look for in the current
// frame, stored as columns, and where they look.

namespace rgbd_pose {

// Where direct costs look their points up: in the current frame, at one pyramid
// level, as seen after one motion. Around a point's pixel the image is a plane
// (its value and derivatives there), so residuals need only columns of numbers,
// which are computed again for each motion that the solver tries.
struct DirectInput {
  const FrameView* cur = nullptr;
  int level = 0;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // cur_from_prev
  Eigen::Vector3d t = Eigen::Vector3d::Zero();      // m

  Lens<double> lens;  // of the current camera

  // Whether rows of the current images were exposed at times other than the
  // time to which the motion refers (FrameView::timing).
  bool moves_color = false;
  bool moves_depth = false;

  // The cells to skip (FrameView::moving), and the factor from pixels of the
  // image that is read to pixels of the full resolution.
  const CellMask* moving = nullptr;
  double px_to_full = 1.0;

  // The change of brightness between the frames: a gray level of the previous
  // frame becomes gain * gray + bias in the current one.
  double gain = 1.0;
  double bias = 0.0;

  static constexpr double kMinDepth = 0.1;  // m; nearer points are not used
};

// Where a point is seen (px of the image that is read) and its depth (m).
template <typename D>
struct ProjectedPoint {
  D u, v, z;
};

// Defaults of the constants of a direct residual type (see DirectCostOf).
struct DirectResidual {
  static constexpr int kRows = 1;
  static constexpr int kDegreesOfFreedom = 1;
  static constexpr bool kIsWhitened = true;
  static constexpr int kScaleGroup = 0;        // see MotionCost::scale_group
  static constexpr int kMaxPoints = 3000;      // see DirectOptions
  static constexpr double kInformation = 1.0;  // see DirectCostOf
  // Whether the cost reads the gray levels of the current pyramid level, whose
  // brightness may have changed.
  static constexpr bool kSeesBrightness = false;
};

// The pixel of each cell with the largest gradient. A cell gives none if its
// gradients are below min_gradient, or if the depth around that pixel has holes
// or edges. Columns: X (m, FrameView::reference_from_stamp), sigma of its depth
// (m), its gray level.
void TexturedPoints(const FrameView& frame, int level,
                    const DirectOptions& options, PackedColumns* points);

// The centre of each cell, textured or not, if the surface around it is flat.
// Its depth is that of a plane through 5 x 5 measured depths. Columns: X (m),
// the plane N . X = 1 (1 / m), the sigma of a single measured depth there (m).
void SmoothPoints(const FrameView& frame, int /*level*/,
                  const DirectOptions& options, PackedColumns* points);

// Estimates how gray levels change between the frames, which have separate
// exposures: sets input->gain and bias by robust regression over the textured
// points that are visible at input's motion. Weak priors (gain 1 +- 0.3,
// bias 0 +- 40 gray levels) decide where there is no texture.
void EstimateBrightness(const PackedColumns& points, DirectInput* input);

}  // namespace rgbd_pose
