#pragma once

#include <Eigen/Core>

#include "core/estimation/frame_view.h"

namespace rgbd_pose {

// Where direct costs look their points up: in the current frame, at one level
// of it, as seen after one motion. Around the place where a point is seen the
// image counts as a plane (its value and derivatives there), so that what the
// residuals are made of are columns of numbers, no longer an image; the columns
// are made again wherever the solver tries a motion.
struct DirectInput {
  const FrameView* cur = nullptr;
  int level = 0;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // cur_from_prev
  Eigen::Vector3d t = Eigen::Vector3d::Zero();      // m

  Lens<double> lens;  // of the current camera

  // Whether rows of the current images were exposed at other times than the
  // motion is of (FrameView::timing).
  bool moves_color = false;
  bool moves_depth = false;

  // What is not looked at (FrameView::moving), and its pixels for one of the
  // image that is read.
  const CellMask* moving = nullptr;
  double px_to_full = 1.0;

  // The change of brightness from the previous frame to the current one: gray
  // levels there are gain * gray + bias.
  double gain = 1.0;
  double bias = 0.0;

  static constexpr double kMinDepth = 0.1;  // m; what is nearer is not seen
};

// Where a point is seen, in px of the image that is read there, and its depth
// (m).
template <typename D>
struct ProjectedPoint {
  D u, v, z;
};

// What a direct cost need not say: it is so of most (see DirectCostOf).
struct DirectResidual {
  static constexpr int kRows = 1;
  static constexpr int kDegreesOfFreedom = 1;
  static constexpr bool kIsWhitened = true;
  static constexpr int kScaleGroup = 0;        // see MotionCost::scale_group
  static constexpr int kMaxPoints = 3000;      // see DirectOptions
  static constexpr double kInformation = 1.0;  // likewise
  // Whether it reads gray levels, whose brightness may have changed.
  static constexpr bool kSeesBrightness = false;
};

}  // namespace rgbd_pose
