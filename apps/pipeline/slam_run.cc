#include "apps/pipeline/slam_run.h"

namespace rgbd_pose {

TrackedFrame SlamRun::Track(const PreparedFrame& frame,
                            const Rigid3d* cur_from_prev_guess) {
  frames_.push_back(slam_.Track(frame, cur_from_prev_guess));
  TrackedFrame tracked = frames_.back().tracked;
  tracked.world_from_cam = frames_.back().map_from_cam();
  tracked.segment = frames_.back().segment;
  return tracked;
}

Trajectory SlamRun::FinishPath() {
  slam_.Finish();
  return slam_.Path();
}

}  // namespace rgbd_pose
