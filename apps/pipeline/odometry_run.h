#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/pipeline/settings.h"
#include "apps/pipeline/slam.h"
#include "core/estimation/motion_estimate.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/frame_stream.h"
#include "frontend/tracking/motion_guess.h"
#include "frontend/tracking/odometry.h"

namespace rgbd_pose {

// How the whitened residuals and the robust weights of a run's matches are
// spread, over all frames.
struct ResidualHistogram {
  // Bins of norms (sigmas) and of weights; the last bin of weights holds 1.
  static constexpr double kNormBin = 0.1;
  static constexpr double kWeightBin = 0.05;

  int64_t matches = 0;  // that some cost could use
  std::array<int64_t, 80> norms = {};
  int64_t norms_above = 0;  // the last bin
  std::array<int64_t, 20> weights = {};
  int64_t weights_zero = 0;             // exactly
  std::array<int64_t, 7> degrees = {};  // matches of 0 to 6 measurements

  // Adds the matches of one frame.
  void Add(const MotionEstimate& estimate);
};

// What is known of a sequence besides its frames; null: nothing. Must outlive
// the run.
struct RunInputs {
  const MotionGuess* motion_guess = nullptr;
  // The share of frames that may be damaged, see FrameStream.
  double max_damaged = 0.05;
};

// What becomes of a sequence.
struct RunResults {
  std::vector<TrackedFrame> frames;  // one an input frame, in order
  std::vector<std::string> damaged;  // input frames left out, and why
  Trajectory trajectory;             // of the frames that were not lost
  ResidualHistogram residuals;       // of their matches

  // Against the ground truth. Nothing where there is none, or where no pose can
  // be compared: then no_evaluation says why.
  std::optional<EvaluationReport> evaluation;
  std::string no_evaluation;

  // One line on what the errors say of the input, or empty.
  std::string Warning() const {
    return evaluation.has_value()
               ? Sim3Warning(evaluation->sim3, evaluation->ate.rmse)
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

  // The frames so far, and those that could not be read.
  const std::vector<TrackedFrame>& frames() const { return results_.frames; }
  const std::vector<std::string>& damaged() const { return results_.damaged; }
  void set_damaged(const std::vector<std::string>& damaged) {
    results_.damaged = damaged;
  }

  const RunInputs& inputs() const { return inputs_; }

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

// The poses of all frames that were not lost.
Trajectory TrackedTrajectory(const std::vector<TrackedFrame>& frames);

// By an Odometry.
class OdometryRun final : public SequenceRun {
 public:
  // Throws InputError for invalid settings.
  OdometryRun(const OdometrySettings& settings, const Camera& camera,
              const RunInputs& inputs = {})
      : SequenceRun(inputs), odometry_(MakeOdometry(settings, camera)) {}

  const Odometry& odometry() const override { return odometry_; }

 private:
  TrackedFrame Track(const PreparedFrame& frame,
                     const Rigid3d* cur_from_prev_guess) override {
    return odometry_.Track(frame, cur_from_prev_guess);
  }
  Trajectory FinishPath() override { return TrackedTrajectory(frames()); }

  Odometry odometry_;
};

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

// Sends all frames of a source through one or several runs of the same
// frontend, each frame read and prepared once, by `threads` >= 1 threads ahead.
// `on_frame` hears of each frame that all have tracked, and says whether to go
// on; may be empty. Returns why the source ended before its last frame, or
// nothing. Damaged frames are left out, as the first run's inputs say. Throws
// InputError where no frame can be read.
std::string TrackAll(FrameSource* source, int threads,
                     const std::vector<SequenceRun*>& runs,
                     const std::function<bool(const Frame& frame)>& on_frame);

// Throws InputError if no frame of the source is near in time to the ground
// truth, as far as that is known before the work, when it is better said.
void RequireOverlap(const FrameSource& source, const Trajectory& truth);

// What the motions that frames were tracked by are worth.
RunConsistency JudgeFrames(const std::vector<TrackedFrame>& frames,
                           const Trajectory& truth,
                           const TruthNoise& noise = {});

}  // namespace rgbd_pose
