#include "apps/pipeline/slam_run.h"

#include <utility>

namespace rgbd_pose {

TrackedFrame SlamRun::Track(const PreparedFrame& frame,
                            const Rigid3d* cur_from_prev_guess) {
  SlamFrame in_map = slam_.Track(frame, cur_from_prev_guess);
  if (in_map.tracked.previous_is_reference) {
    frames_.back().tracked.is_reference = true;
  }
  TrackedFrame tracked = in_map.tracked;
  tracked.world_from_cam = in_map.map_from_cam();
  tracked.segment = in_map.segment;
  // Once in memory is enough for an hour of frames.
  in_map.tracked.edges = {};
  frames_.push_back(std::move(in_map));
  return tracked;
}

Trajectory SlamRun::FinishPath() {
  slam_.Finish();
  return slam_.Path();
}

}  // namespace rgbd_pose
