#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/residual_histogram.h"
#include "apps/pipeline/settings.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/frame_stream.h"
#include "frontend/tracking/motion_guess.h"
#include "frontend/tracking/odometry.h"

namespace rgbd_pose {

// What is known of a sequence beside its frames; null: nothing. Must outlive
// the run.
struct RunInputs {
  const MotionGuess* motion_guess = nullptr;
};

// What becomes of a sequence.
struct RunResults {
  std::vector<TrackedFrame> frames;  // one an input frame, in order
  Trajectory trajectory;             // of the frames that were not lost
  ResidualHistogram residuals;       // of their matches

  // Against the ground truth. Nothing where there is none, or where no pose can
  // be compared: then no_evaluation says why.
  std::optional<EvaluationReport> evaluation;
  std::string no_evaluation;

  // One line on what the errors say of the input, or empty.
  std::string Warning() const {
    return evaluation.has_value()
               ? LikenessWarning(evaluation->likeness, evaluation->ate.rmse)
               : "";
  }

  // Share of frames with a pose, 0 to 1.
  double TrackedShare() const {
    return frames.empty() ? 0.0
                          : static_cast<double>(trajectory.size()) /
                                static_cast<double>(frames.size());
  }
};

// Tracks a sequence frame by frame and collects what becomes of it.
class SequenceRun {
 public:
  explicit SequenceRun(const RunInputs& inputs) : inputs_(inputs) {}
  virtual ~SequenceRun() = default;

  // Tracks the next frame.
  void Add(const StreamedFrame& next);

  // What the last frame was tracked by, and what may be done ahead.
  virtual const Odometry& odometry() const = 0;

  // The frames so far.
  const std::vector<TrackedFrame>& frames() const { return results_.frames; }

  // After the last frame, once; compared with a ground truth (world from
  // camera) unless it is null.
  RunResults Finish(const Trajectory* ground_truth);

 protected:
  virtual TrackedFrame Track(const PreparedFrame& frame,
                             const Rigid3d* cur_from_prev_guess) = 0;
  // The poses of all frames that were not lost, after the last one.
  virtual Trajectory FinishPath() = 0;

 private:
  RunInputs inputs_;
  RunResults results_;
};

// By an Odometry.
class OdometryRun final : public SequenceRun {
 public:
  // Throws InputError for settings that are of no use.
  OdometryRun(const OdometrySettings& settings, const Camera& camera,
              const RunInputs& inputs = {});

  const Odometry& odometry() const override { return odometry_; }

 private:
  TrackedFrame Track(const PreparedFrame& frame,
                     const Rigid3d* cur_from_prev_guess) override {
    return odometry_.Track(frame, cur_from_prev_guess);
  }
  Trajectory FinishPath() override;

  Odometry odometry_;
};

// Sends all frames of a source through one or several runs of the same
// frontend, each frame read and prepared once, by `threads` >= 1 threads ahead.
// `on_frame` hears of each frame that all have tracked, and says whether to go
// on; may be empty. Throws InputError for an unreadable frame.
void TrackAll(FrameSource* source, int threads,
              const std::vector<SequenceRun*>& runs,
              const std::function<bool(const Frame& frame)>& on_frame);

// Throws InputError if no frame of the source is near in time to the ground
// truth, as far as that is known before the work, when it is better told.
void RequireOverlap(const FrameSource& source, const Trajectory& truth);

// The poses of all frames that were not lost.
Trajectory TrackedTrajectory(const std::vector<TrackedFrame>& frames);

}  // namespace rgbd_pose
