#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/motion_estimate.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "core/inertial/camera_imu.h"
#include "core/inertial/gravity_estimate.h"
#include "core/inertial/mean_force.h"
#include "frontend/settings/sequence.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/slam.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/frame_stream.h"
#include "frontend/tracking/odometry.h"

namespace rgbd_pose {

// Histograms of whitened residuals and robust weights of all matches of a run.
struct ResidualHistogram {
  // Bin widths for norms (sigmas) and weights. The last weight bin includes 1.
  static constexpr double kNormBin = 0.1;
  static constexpr double kWeightBin = 0.05;

  int64_t matches = 0;  // used by at least one cost
  std::array<int64_t, 80> norms = {};
  int64_t norms_above = 0;  // beyond the last bin
  std::array<int64_t, 20> weights = {};
  int64_t weights_zero = 0;             // exactly
  std::array<int64_t, 7> degrees = {};  // matches with 0 to 6 measurements

  // Adds the matches of one frame.
  void Add(const MotionEstimate& estimate);
};

struct RunResults {
  std::vector<TrackedFrame> frames;  // one per input frame, in order
  std::vector<std::string> damaged;  // input frames left out, and why
  RepeatedCounts repeated;           // images that were sent twice
  Trajectory trajectory;             // of the frames that were not lost
  ResidualHistogram residuals;       // of the matches

  // Empty without ground truth, or for the reason in no_evaluation.
  std::optional<EvaluationReport> evaluation;
  std::string no_evaluation;

  // In the world of the trajectory; nothing without an inertial sensor.
  std::optional<GravityEstimate> gravity;

  // What was learnt of an inertial sensor; nothing if none can be used.
  std::optional<CameraImu> imu;

  double TrackedShare() const {
    if (frames.empty()) return 0.0;
    return static_cast<double>(trajectory.size()) / frames.size();
  }
};

// Tracks a sequence with an Odometry or a Slam, and collects the results.
class SequenceRun {
 public:
  // With an Odometry. Throws InputError for invalid settings.
  SequenceRun(const OdometrySettings& settings, const RgbdCamera& camera,
              const RunInputs& inputs = {})
      : inputs_(inputs), odometry_(MakeOdometry(settings, camera)) {
    if (inputs.imu.has_value()) UseImu(*inputs.imu);
  }

  // With a Slam: frames and debug images have the poses known at the time; the
  // trajectory has the final poses. Throws InputError for invalid settings.
  SequenceRun(const OdometrySettings& odometry, const SlamSettings& settings,
              const RgbdCamera& camera, const RunInputs& inputs = {})
      : inputs_(inputs),
        slam_(std::make_unique<Slam>(odometry, settings, camera)) {
    if (inputs.imu.has_value()) UseImu(*inputs.imu);
  }

  // Adds the next frame of a stream and the inertial samples with it.
  void Add(const StreamedFrame& next);

  // Tracks any frame, as Odometry::Track does. The guess may be null.
  void Add(const PreparedFrame& frame, const Rigid3d* cur_from_prev_guess);

  // See Odometry::UseImu and AddImu. RunInputs::imu is used without a call.
  void UseImu(const ImuSensor& sensor);
  void AddImu(const std::vector<ImuSample>& samples);

  // The odometry that tracks the frames and can prepare frames in advance.
  const Odometry& odometry() const {
    return slam_ == nullptr ? *odometry_ : slam_->odometry();
  }

  // Complete after Finish; null without a Slam. Load maps before any frame.
  Slam* slam() const { return slam_.get(); }

  // The SLAM results of each frame, without edges (these are in RunResults).
  const std::vector<SlamFrame>& slam_frames() const { return slam_frames_; }

  // All frames so far, and those that could not be read.
  const std::vector<TrackedFrame>& frames() const { return results_.frames; }
  const std::vector<std::string>& damaged() const { return results_.damaged; }

  // Sets which frames of the source were left out. Call it after the last one.
  void SetDamaged(const std::vector<std::string>& damaged) {
    results_.damaged = damaged;
  }

  // The current poses of the frames that were not lost.
  Trajectory Path() const;

  const RunInputs& inputs() const { return inputs_; }

  // Call once, at the end. Compares the path with the truth unless it is null.
  RunResults Finish(const Trajectory* ground_truth);

 private:
  TrackedFrame Track(const PreparedFrame& frame,
                     const Rigid3d* cur_from_prev_guess);
  // Finishes the Slam, and brings the frames into its final world.
  void FinishSlam();
  std::optional<GravityEstimate> Gravity() const;

  RunInputs inputs_;
  std::optional<Odometry> odometry_;  // nothing with a Slam
  std::unique_ptr<Slam> slam_;        // null: without a map
  std::optional<ForceMeter> meter_;   // nothing with a Slam, which has one
  std::vector<SlamFrame> slam_frames_;
  RunResults results_;
};

// Sends all frames of a source through one or more runs with the same frontend.
// Each frame is read and prepared once, in advance, by `threads` >= 1 threads.
// `on_frame` is called for each tracked frame and returns whether to continue;
// it may be empty. Returns why the source ended before its last frame, or an
// empty string. Damaged frames are left out, up to max_damaged of the first
// run. Throws InputError if no frame can be read.
std::string TrackAll(FrameSource* source, int threads,
                     const std::vector<SequenceRun*>& runs,
                     const std::function<bool(const Frame& frame)>& on_frame);

// Judges the motions of tracked frames and their covariances against the truth,
// also with its clock as `alignment` has it.
RunConsistency JudgeFrames(const std::vector<TrackedFrame>& frames,
                           const Trajectory& truth, const TruthNoise& noise,
                           const TruthAlignment& alignment);

}  // namespace rgbd_pose
