#pragma once

#include <utility>
#include <vector>

#include "apps/pipeline/odometry_run.h"
#include "apps/pipeline/slam.h"

namespace rgbd_pose {

// A sequence tracked by a Slam. Frames and what is drawn of them have the poses
// that were known at the time, the trajectory those of the end.
class SlamRun final : public SequenceRun {
 public:
  // Throws InputError for invalid settings.
  SlamRun(const OdometrySettings& odometry, const SlamSettings& settings,
          const Camera& camera, const RunInputs& inputs = {})
      : SequenceRun(inputs), slam_(odometry, settings, camera) {}

  // Before the first frame, see Slam::Load.
  void Load(KeyframeMap map, bool is_held) {
    slam_.Load(std::move(map), is_held);
  }

  const Odometry& odometry() const override { return slam_.odometry(); }

  // After Finish: the map.
  const Slam& slam() const { return slam_; }

  // What became of each frame; RunResults has the edges.
  const std::vector<SlamFrame>& slam_frames() const { return frames_; }

 private:
  TrackedFrame Track(const PreparedFrame& frame,
                     const Rigid3d* cur_from_prev_guess) override;
  Trajectory FinishPath() override;

  Slam slam_;
  std::vector<SlamFrame> frames_;
};

}  // namespace rgbd_pose
