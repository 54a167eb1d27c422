#include "apps/compare/compare_sequence.h"

#include "apps/shell/progress_bar.h"
#include "frontend/sources/frame_stream.h"

namespace rgbd_pose {

std::vector<LossRun> CompareLosses(FrameSource* source,
                                   const std::optional<Trajectory>& truth,
                                   const std::vector<std::string>& losses,
                                   const OdometrySettings& settings,
                                   int threads) {
  std::vector<Odometry> odometries;
  std::vector<LossRun> runs;
  for (const std::string& loss : losses) {
    OdometrySettings own = settings;
    own.loss = loss;
    odometries.push_back(MakeOdometry(own, source->camera().camera));
    runs.emplace_back();
    runs.back().loss = loss;
  }
  {
    ProgressBar bar("tracking", static_cast<int>(source->timestamps().size()));
    FrameStream stream(
        source,
        [&odometries](const Frame& frame) {
          return odometries[0].Prepare(frame);
        },
        threads);
    while (const std::optional<StreamedFrame> next = stream.Next()) {
      for (size_t k = 0; k < losses.size(); ++k) {
        runs[k].frames.push_back(odometries[k].Track(*next->frame));
      }
      bar.Update(static_cast<int>(runs[0].frames.size()));
    }
  }
  for (LossRun& run : runs) {
    run.trajectory = TrackedTrajectory(run.frames);
    if (truth.has_value() && !run.trajectory.empty()) {
      run.report = Evaluate(run.trajectory, *truth);
    }
  }
  return runs;
}

}  // namespace rgbd_pose
