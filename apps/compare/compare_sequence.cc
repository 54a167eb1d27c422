#include "apps/compare/compare_sequence.h"

#include <glog/logging.h>

#include "apps/pipeline/sequence.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"

namespace rgbd_pose {

std::vector<LossRun> CompareLosses(FrameSource* source,
                                   const std::optional<Trajectory>& truth,
                                   const std::vector<std::string>& losses,
                                   OdometrySettings settings, int threads) {
  if (truth.has_value()) RequireOverlap(*source, *truth);
  std::vector<OdometryRun> runs;
  for (const std::string& loss : losses) {
    settings.estimator.loss = loss;
    runs.emplace_back(settings, source->camera().camera);
  }
  std::vector<SequenceRun*> all;
  for (OdometryRun& run : runs) all.push_back(&run);
  {
    ProgressBar bar("tracking", static_cast<int>(source->timestamps().size()));
    const std::string stopped =
        TrackAll(source, threads, all, [&bar](const Frame& frame) {
          bar.Update(frame.index + 1);
          return true;
        });
    Warn(DroppedFrames(*source, all[0]->damaged()));
    if (!stopped.empty()) LOG(WARNING) << "ended early: " << stopped;
  }
  std::vector<LossRun> results;
  for (size_t i = 0; i < losses.size(); ++i) {
    results.push_back(
        {runs[i].Finish(truth.has_value() ? &*truth : nullptr), losses[i]});
  }
  return results;
}

}  // namespace rgbd_pose
