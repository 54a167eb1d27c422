#pragma once

#include "apps/python/pickling.h"
#include "core/geometry/camera.h"
#include "core/pose_graph/relative_pose.h"
#include "frontend/tracking/tracked_frame.h"

// Of what is a part of several classes of Python.

namespace rgbd_pose {

inline void EachField(PickledBytes* bytes, RgbdCamera& c) {
  (*bytes)(c.camera, c.depth_scale, c.depth_correction.inverse_depth_offset,
           c.depth_correction.depth_from_color, c.color_shutter,
           c.depth_shutter);
}

inline void EachField(PickledBytes* bytes, RelativePose& pose) {
  (*bytes)(pose.ref, pose.cur, pose.cur_from_ref, pose.covariance);
}

inline void EachField(PickledBytes* bytes, TrackedFrame& f) {
  (*bytes)(f.index, f.timestamp, f.status, f.reason, f.world_from_cam,
           f.segment, f.reference, f.cur_from_reference, f.is_reference,
           f.relocalised, f.previous_is_reference, f.is_predicted, f.edges,
           f.source, f.matches, f.inliers, f.iterations, f.sigma, f.decode_ms,
           f.track_ms, f.match_ms, f.solve_ms, f.reference_ms, f.relocalise_ms);
}

}  // namespace rgbd_pose
