#pragma once

#include <Eigen/Core>

#include "core/estimation/frame_view.h"

namespace rgbd_pose {

// Where direct costs look their points up: in the current frame, at one pyramid
// level, as seen after one motion. Around a point's pixel the image is
// approximated by a plane (its value and derivatives there). So the residuals
// need only columns of numbers and no image; the columns are computed again for
// each motion that the solver tries.
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
  // Whether the cost reads gray levels, whose brightness may have changed.
  static constexpr bool kSeesBrightness = false;
};

}  // namespace rgbd_pose
