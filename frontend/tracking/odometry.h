#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/estimation/estimator.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/repeated_images.h"
#include "frontend/frame/stamp_jitter.h"
#include "frontend/places/relocaliser.h"
#include "frontend/tracking/carried_region.h"
#include "frontend/tracking/inertial_tracking.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/shutter_tracking.h"
#include "frontend/tracking/tracked_frame.h"
#include "frontend/tracking/tracker.h"
#include "frontend/tracking/tracking_attempts.h"

namespace rgbd_pose {

// What to do with frames whose motion is not found. Except after kStop, each is
// searched for among earlier references, and tracking continues if it is found.
enum class LostPolicy {
  kStop,        // every further frame is lost, without a search
  kHold,        // the last pose is reported until the place is found again
  kPredict,     // the pose continues with the last motion
  kNewSegment,  // a new segment starts there; for a while, each of its frames
                // is searched for in the previous segment
};

// How the exposure times of the rows of a frame are used.
enum class ShutterUse {
  kCamera,  // exposure times of the frame are compensated by the velocity found
  kNone,    // everything counts as seen at the stamp of the frame
};

// When to change the reference, where to start, when to give up.
struct OdometryOptions {
  // A new reference is taken when a smaller share of the reference agrees, or
  // when the reference has moved by more than this in the image on average.
  double min_reference_share = 0.5;
  double max_flow_px = 60.0;

  // What to do with frames whose motion is not found.
  LostPolicy on_lost = LostPolicy::kNewSegment;

  // How the exposure times of rows and of depth are used.
  ShutterUse shutter = ShutterUse::kCamera;
  // If unknown times move surfaces by more, see TrackingGuess::aligns_depth.
  double max_time_shift = 3.5e-3;  // m

  // How long (s) the previous segment is searched for after a new one starts.
  double new_segment_after = 1.5;

  // Standard deviations of a motion guess that comes without a covariance.
  double guess_sigma_rotation = 0.01;     // rad
  double guess_sigma_translation = 0.01;  // m

  // Returns one line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Tracks a camera frame by frame against a reference frame (keyframe). The
// reference changes when the view has changed; if the view returns, an earlier
// reference is used again. Every frame gets a result.
class Odometry {
 public:
  // Throws InputError for invalid options (see Check).
  Odometry(const OdometryOptions& options, std::unique_ptr<Tracker> tracker);

  // `cur_from_prev_guess`: the motion since the previous frame from another
  // source (wheels, an inertial sensor). It is tried first and used only if
  // the images agree; while tracking is lost, the pose follows it. Its
  // covariance, as in MotionEstimate, becomes the prior of costs that have one;
  // null: unknown (see OdometryOptions). The images are copied: their memory
  // may be reused for the next frame. Throws InputError, and counts no frame,
  // if they do not have the camera's size, or if the guess is not finite.
  TrackedFrame Track(const Frame& frame,
                     const Rigid3d* cur_from_prev_guess = nullptr,
                     const MotionMatrix* guess_covariance = nullptr);

  // The same for a frame whose derived data is reused. Shares its images.
  TrackedFrame Track(const PreparedFrame& frame,
                     const Rigid3d* cur_from_prev_guess = nullptr,
                     const MotionMatrix* guess_covariance = nullptr);

  // How many frames had an image of the one before, under a new time stamp.
  // They are `degraded` at best: nothing is learnt from them, and later frames
  // are not tracked against them.
  const RepeatedCounts& repeated() const { return repeated_.counts(); }

  // Precomputes everything about a frame that does not depend on other frames.
  // May be called from any thread while this object lives.
  void Prepare(const PreparedFrame& frame) const { tracker_->Prepare(frame); }

  // Says what is known of an inertial sensor beside the camera; call it before
  // the first frame. It helps to track if it has a gyroscope whose mounting is
  // known, and as long as images confirm it. Where they show nothing, the pose
  // goes on by it for up to two seconds, as `degraded`.
  void UseImu(const ImuSensor& sensor) {
    if (CameraImu::CanUse(sensor)) inertial_.emplace(sensor);
  }

  // Adds samples of that sensor, with its stamps and axes, in order. Those up
  // to the last row of a frame are needed before the frame is tracked. Without
  // UseImu they have no effect.
  void AddImu(const std::vector<ImuSample>& samples) {
    if (inertial_.has_value()) inertial_->Add(samples);
  }

  // What is known of that sensor by now; null if it cannot be used.
  const CameraImu* imu() const {
    return inertial_.has_value() ? &inertial_->imu() : nullptr;
  }

  // Inserts a frame from elsewhere (a map, an earlier visit) as the latest
  // keyframe. If the view returns to it, frames are tracked against it, and a
  // lost frame is searched for there first. Its id: the index of the frame if
  // it was tracked here, else below -1. Its pose: in the world of these poses.
  // Its segment is ignored. Returns false and changes nothing if the frame has
  // too few features or depths. Throws InputError if its images cannot be
  // decoded or do not have the camera's size.
  bool InsertKeyframe(const Keyframe& inserted);

  // The pose after the last frame, even if that was lost (see LostPolicy).
  Rigid3d WorldFromCam() const;

  // The matches by which the last frame was tracked (prev: its reference).
  const FeatureMatches& last_matches() const {
    return attempts_.kept().matches;
  }
  // The motion estimate of the last frame.
  const MotionEstimate& last_estimate() const {
    return attempts_.kept().estimate;
  }

  // Returns the keyframe with this id (TrackedFrame::reference); null if it is
  // no longer kept. Its images are as measured; if rows were exposed at
  // different times, its velocity (Frame::twist) and reference_from_stamp say
  // where its points are. They are final once the next frame has been tracked.
  const OdometryKeyframe* FindKeyframe(int id) const {
    return keyframes_.Find(id);
  }

  // Whether the exposure times of the rows of a frame have to be considered.
  bool HasShutter(const Frame& frame) const {
    return options_.shutter == ShutterUse::kCamera && !frame.IsOneMoment();
  }

  // The velocity of the last frame if it was tracked and its rows were exposed
  // at different times; see Frame::twist.
  const std::optional<Twist>& last_twist() const { return state_.twist; }

 private:
  // The pose predicted from a motion guess.
  struct Prediction {
    Rigid3d cur_from_prev, cur_from_ref;
    MotionMatrix covariance;              // of cur_from_ref
    const MotionMatrix* given = nullptr;  // of cur_from_prev, if known
  };

  // How hard a frame is tried: by features where coarse images have put it; by
  // pixels as well, if these are too few; from other starts and by descriptors.
  enum class Effort { kQuick, kPixels, kEverything };

  // The end of a segment.
  struct EarlierSegment {
    int reference = -1;    // its last reference
    Rigid3d cur_from_ref;  // of its last pose
    double left_at = 0.0;  // time stamp of the first new frame, s
  };

  // Throws InputError if the images do not have the size of the camera.
  void RequireSize(const Frame& frame) const;

  // The stages of Track, in this order. The first sets what is known of the
  // frame's times before its images are looked at.
  void Begin(const Frame& frame);
  void UpdateInterval(double timestamp);
  void FindPose(const PreparedFrame& frame,
                const std::optional<Prediction>& prediction,
                TrackedFrame* result);
  // Degrades a pose whose segment is not yet connected, whose inflation is
  // unusual, or that was doubted before.
  void Judge(TrackedFrame* result);
  // Degrades a frame whose covariance was inflated far more than usual.
  void JudgeInflation(TrackedFrame* result);
  // Learns from a pose what is carried along and what the sensor's errors are.
  void Learn(const Frame& frame, const TrackedFrame& result);
  // Keeps the frame as the one that the next is aligned to, if it is fit.
  void KeepLast(const PreparedFrame& frame, TrackedFrame* result);

  // Covariance of the motion due to the uncertain capture time at `twist`.
  MotionMatrix TimingCovariance(const Frame& frame, const Twist& twist) const;

  Prediction Predict(const Rigid3d& cur_from_prev,
                     const MotionMatrix* covariance) const;
  TrackingGuess GuessOf(const Rigid3d& cur_from_ref) const {
    return {cur_from_ref, state_.aligns_depth};
  }
  bool Follow(const PreparedFrame& frame,
              const std::optional<Prediction>& prediction,
              TrackedFrame* result);
  // Returns the motion since the last frame by coarse images; nothing if they
  // do not determine it.
  std::optional<Rigid3d> AlignToLast(
      const PreparedFrame& frame, const std::optional<Prediction>& prediction);
  // The motion since the last frame as it is expected without looking: at
  // constant velocity, turned by the gyroscope if there is one.
  Rigid3d Expected() const;
  // Tracks a frame against state_.reference from one start after the other, as
  // far as state_.effort allows. Returns whether that yields a pose.
  bool Try(const PreparedFrame& frame,
           const std::optional<Prediction>& prediction,
           const VelocityPrior* velocity, TrackedFrame* result);
  // The velocity by what was measured between the last frame and this one.
  std::optional<Twist> TwistSinceLast(
      const std::optional<Prediction>& prediction) const;
  // Tracks a frame against state_.reference. Returns it as tracked, or null if
  // lost. The refinement is left to Follow.
  const PreparedFrame* Look(const PreparedFrame& frame,
                            const std::optional<Prediction>& prediction,
                            TrackedFrame* result);
  bool IsTrusted(const PreparedFrame* frame, const TrackedFrame& result) const;
  // Makes the last frame a keyframe and tracks the frame against it. Returns
  // `found`, the result of Look, unless the new result is better.
  const PreparedFrame* LookFromLast(const PreparedFrame& frame,
                                    const std::optional<Prediction>& prediction,
                                    const PreparedFrame* found,
                                    TrackedFrame* result);
  // Returns false and changes nothing without a suitable last frame.
  bool MakeLastReference(TrackedFrame* result);
  bool Relocalise(const PreparedFrame& frame, TrackedFrame* result);
  // Moves a pose that images do not show by the inertial sensor. Returns false,
  // with unchanged state, if that does not know the way.
  bool GoOnBlindly(const Frame& frame, TrackedFrame* result);
  void GoOnWithVelocity(const Frame& frame);
  void HandleLost(const PreparedFrame& frame,
                  const std::optional<Prediction>& prediction,
                  TrackedFrame* result);
  // Changes nothing if the frame cannot be a reference.
  void StartSegment(const PreparedFrame& frame, const Rigid3d& world_from_cam,
                    TrackedFrame* result);
  // Searches for a frame of a new segment in the previous one; continues there.
  void ReturnToEarlierSegment(const PreparedFrame& frame, TrackedFrame* result);

  // Sets the pose from the motion found since state_.reference. Adds the motion
  // as the first edge of the result.
  void TakeMotion(TrackedFrame* result);
  // Updates the state after tracking against state_.reference, which may
  // change.
  void Accept(const PreparedFrame& frame, TrackedFrame* result);
  bool NeedsNewReference() const;
  // Returns null, and why, if the frame cannot be a reference. `last`: against
  // which it was tracked, or null; `in_use`: see Keyframes.
  OdometryKeyframe* AddKeyframe(Keyframe keyframe, const Reference* last,
                                const OdometryKeyframe* in_use,
                                std::string* why_not);
  // Returns false, with unchanged state, if the frame cannot be a reference.
  bool TakeReference(const PreparedFrame& frame, const Rigid3d& world_from_cam,
                     TrackedFrame* result);

  // What is known when a frame has been tracked, for the next one. An attempt
  // is taken back by assigning the state before it.
  struct State {
    explicit State(const Tracker* tracker) : shutter_tracking(tracker) {}

    // The last frame.
    double timestamp = 0.0;      // s
    double interval = 0.0;       // since the frame before, s
    bool has_shutter = false;    // see HasShutter
    bool aligns_depth = true;    // see TrackingGuess
    std::optional<Twist> twist;  // see last_twist
    MotionMatrix twist_covariance = MotionMatrix::Zero();  // TrackingResult
    // Of capture time, and of accelerations while rows are exposed. Where it is
    // large, depth is not aligned in the next frame.
    MotionMatrix timing_covariance = MotionMatrix::Zero();

    // Its motion.
    OdometryKeyframe* reference = nullptr;  // null: none yet
    Rigid3d cur_from_ref;
    MotionMatrix covariance = MotionMatrix::Zero();  // of cur_from_ref
    Rigid3d cur_from_prev;                           // between the last two
    std::optional<Rigid3d> aligned;  // the same by coarse images
    std::optional<CameraTurn> turn;  // the same by the gyroscope
    Effort effort = Effort::kQuick;
    bool has_few_features = false;
    // The last frame, to become a keyframe, if it was tracked and is none.
    std::optional<Keyframe> last;

    // The camera.
    ShutterTracking shutter_tracking;
    StampJitter stamp_jitter;  // of depth
    CarriedRegion carried;     // what the camera sees of its carrier
    // The 90 % quantile of TrackingResult::covariance_factor.
    double usual_inflation = 4.0;

    // The last frame that images have found without doubt.
    struct Seen {
      int reference = -1;                              // at that time
      Rigid3d cur_from_ref;                            // its motion since then
      MotionMatrix covariance = MotionMatrix::Zero();  // of cur_from_ref
    } seen;

    // Whether and where it was lost.
    bool is_lost = false;
    bool is_doubtful = false;     // something moved in the last frame
    bool is_unconnected = false;  // the last frame started a segment
    bool is_predicted = false;    // see TrackedFrame
    int segment = 0;
    int latest_segment = 0;
    // The end of the previous segment, as long as it is searched for.
    std::optional<EarlierSegment> earlier_segment;
  };

  OdometryOptions options_;
  std::unique_ptr<Tracker> tracker_;
  Keyframes keyframes_;
  Relocaliser relocaliser_;
  TrackingAttempts attempts_;  // at the last frame
  State state_;
  std::optional<InertialTracking> inertial_;  // nothing: no such sensor
  RepeatedImages repeated_;
  bool is_repeated_ = false;  // whether repeated_ noticed the frame
  int num_frames_ = 0;
};

}  // namespace rgbd_pose
