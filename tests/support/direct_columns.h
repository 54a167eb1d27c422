#pragma once

#include "costs/direct/direct_cost.h"
#include "tests/support/direct_pair.h"

namespace rgbd_pose {

// The points of a pair's previous frame, at most `max_points`.
template <typename Residual>
PackedColumns PointsOf(const DirectPair& pair, int level, int max_points) {
  DirectOptions options;
  options.max_points = max_points;
  PackedColumns points;
  Residual::Points(pair.prev.view, level, options, &points);
  return points;
}

// The input for reading a pair's current frame.
inline DirectInput InputOf(const DirectPair& pair, int level,
                           const Rigid3d& cur_from_prev) {
  DirectInput input;
  input.cur = &pair.cur.view;
  input.level = level;
  input.R = cur_from_prev.rotation.toRotationMatrix();
  input.t = cur_from_prev.translation;
  input.lens = pair.cur.camera.MakeLens();
  input.moves_color = !pair.cur.view.timing.color.IsGlobal();
  input.moves_depth = !pair.cur.view.timing.depth.IsGlobal();
  return input;
}

// The columns of the visible points.
template <typename Residual>
PackedColumns SeenColumns(const DirectInput& input,
                          const PackedColumns& points) {
  PackedColumns seen;
  seen.stride = points.stride + kMaxLanes;
  seen.values.resize(seen.stride * Residual::kColumns);
  PackedColumns* const out = &seen;
  RunVectorised<LookUpKernel<Residual>>(input, points, out);
  return seen;
}

}  // namespace rgbd_pose
