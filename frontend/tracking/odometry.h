#pragma once

#include <memory>

#include "core/estimation/estimator.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"
#include "frontend/places/relocaliser.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/odometry_options.h"
#include "frontend/tracking/shutter_tracking.h"
#include "frontend/tracking/tracked_frame.h"
#include "frontend/tracking/tracker.h"
#include "frontend/tracking/tracking_attempts.h"

namespace rgbd_pose {

// Tracks a camera frame by frame against a reference frame (keyframe), which
// it changes when the view has changed, to an earlier one if the view returns.
// Every frame gets a result.
class Odometry {
 public:
  // Throws InputError for options that are not sound (see Check).
  Odometry(const OdometryOptions& options, std::unique_ptr<Tracker> tracker);

  // By features: with a FeatureTracker.
  Odometry(const OdometryOptions& options, std::unique_ptr<Frontend> frontend,
           Estimator estimator, const TrackerOptions& tracker_options = {});

  // `cur_from_prev_guess`: the motion since the frame before, if something else
  // tells (wheels, an inertial sensor); tried first, and believed only as far
  // as the images agree. While lost, the pose follows it. Its covariance, as
  // that of MotionEstimate, becomes the prior of costs that have one; null: not
  // known (see OdometryOptions). The images are copied: the next ones may be
  // written into the same memory.
  TrackedFrame Track(const Frame& frame,
                     const Rigid3d* cur_from_prev_guess = nullptr,
                     const MotionMatrix* guess_covariance = nullptr);

  // The same with what has been made of the frame already. Shares its images.
  TrackedFrame Track(const PreparedFrame& frame,
                     const Rigid3d* cur_from_prev_guess = nullptr,
                     const MotionMatrix* guess_covariance = nullptr);

  // Makes what does not depend on other frames ahead, in any thread, as long as
  // this lives.
  void Prepare(const PreparedFrame& frame) const { tracker_->Prepare(frame); }

  // Takes a frame of elsewhere (a map, an earlier visit) for a keyframe that
  // was seen a moment ago: where the view returns to it, frames are tracked
  // against it, and a lost one is searched for there first. Its id: that of the
  // frame if it was one of these, else one below -1; its pose: in the world of
  // these poses; its segment does not count. False, and nothing has changed, if
  // the frame shows too little.
  bool InsertKeyframe(const Keyframe& inserted);

  // The pose after the last frame, found or not (see LostPolicy).
  Rigid3d WorldFromCam() const;

  // The matches that the last frame was tracked by (prev: its reference).
  const FeatureMatches& last_matches() const {
    return attempts_.kept().matches;
  }
  // What the estimator made of them.
  const MotionEstimate& last_estimate() const {
    return attempts_.kept().estimate;
  }

  // The keyframe of that number (TrackedFrame::reference); null if there is
  // none any more. Where its rows were exposed at different times, its images
  // are as exposed at one moment: final once the next frame was tracked.
  const OdometryKeyframe* FindKeyframe(int id) const {
    return keyframes_.Find(id);
  }

  // Whether something has to be done about the times of a frame's rows.
  bool HasShutter(const Frame& frame) const {
    return options_.shutter == ShutterUse::kCamera && !frame.IsOneMoment();
  }

  // The velocity of the last frame, where its rows were exposed at different
  // times and it was found; see Frame::twist.
  const std::optional<Twist>& last_twist() const { return twist_; }

 private:
  // What a motion guess makes of the last pose.
  struct Prediction {
    Rigid3d cur_from_prev, cur_from_ref;
    MotionMatrix covariance;  // of cur_from_ref
    bool is_certain = false;  // the guess came with its covariance
  };

  // What a velocity adds to the covariance of the last frame's motion.
  MotionMatrix TimingCovariance(const Frame& frame, const Twist& twist) const;
  Prediction Predict(const Rigid3d& cur_from_prev,
                     const MotionMatrix* covariance) const;
  void Start(const PreparedFrame& frame, TrackedFrame* result);
  bool Follow(const PreparedFrame& frame, const Prediction* prediction,
              TrackedFrame* result);
  // Tracks a frame against reference_: as it was tracked, null if it was not.
  const PreparedFrame* Look(const PreparedFrame& frame,
                            const Prediction* prediction, TrackedFrame* result);
  bool IsTrusted(const PreparedFrame* frame, const TrackedFrame& result) const;
  // Whether little has moved since the last frame.
  bool IsSlow() const;
  // The same against the last frame, which becomes a reference for it; where
  // that is no better, what Look found.
  const PreparedFrame* LookFromLast(const PreparedFrame& frame,
                                    const Prediction* prediction,
                                    const PreparedFrame* found,
                                    TrackedFrame* result);
  // The last frame is the reference of the frames after this one, which has
  // told its velocity.
  bool GoOnFromLast(TrackedFrame* result);
  // False, and nothing has changed, if there is none or it shows too little.
  bool MakeLastReference();
  void KeepLast(const PreparedFrame& frame, const TrackedFrame& result);
  bool Relocalise(const PreparedFrame& frame, TrackedFrame* result);
  void HandleLost(const PreparedFrame& frame, const Prediction* prediction,
                  TrackedFrame* result);
  // False, and nothing has changed, if the frame shows too little.
  bool StartSegment(const PreparedFrame& frame, const Rigid3d& world_from_cam,
                    TrackedFrame* result);
  // Looks for a frame of a new segment in the one before, and goes on there.
  void ReturnToEarlierSegment(const PreparedFrame& frame, TrackedFrame* result);

  // Takes the motion since reference_ that was found for that of the pose, and
  // puts it before other edges.
  void TakeMotion(TrackedFrame* result);
  // What follows from a frame tracked against reference_.
  void Accept(const PreparedFrame& frame, TrackedFrame* result);
  void ChangeReference(const PreparedFrame& frame, TrackedFrame* result);
  bool NeedsNewReference() const;
  // Goes on from an earlier reference instead; false, and nothing has changed,
  // if it does not serve.
  bool ReturnTo(const PreparedFrame& frame, OdometryKeyframe* earlier,
                const Rigid3d& cur_from_earlier_guess, TrackedFrame* result);
  // `in_use`: see Keyframes.
  OdometryKeyframe* AddKeyframe(Keyframe keyframe,
                                std::unique_ptr<Reference> reference,
                                const OdometryKeyframe* in_use);
  // False, and nothing has changed, if the frame shows too little.
  bool TakeReference(const PreparedFrame& frame, const Rigid3d& world_from_cam,
                     TrackedFrame* result);

  OdometryOptions options_;
  std::unique_ptr<Tracker> tracker_;
  Keyframes keyframes_;
  Relocaliser relocaliser_;
  TrackingAttempts attempts_;  // at the last frame
  ShutterTracking shutter_tracking_;
  bool has_shutter_ = false;                              // of the last frame
  std::optional<Twist> twist_;                            // see last_twist
  MotionMatrix twist_covariance_ = MotionMatrix::Zero();  // see TrackingResult
  MotionMatrix timing_covariance_ =
      MotionMatrix::Zero();                // of when it was seen
  OdometryKeyframe* reference_ = nullptr;  // null: none yet
  int num_frames_ = 0;
  Rigid3d cur_from_ref_;                            // of the last frame
  MotionMatrix covariance_ = MotionMatrix::Zero();  // of cur_from_ref_
  Rigid3d cur_from_prev_;                           // between the last two
  double timestamp_ = 0.0;                          // of the last frame, s
  double interval_ = 0.0;                           // since the one before, s
  // The last frame, where it was tracked and is no reference.
  struct LastFrame {
    PreparedFrame frame;
    MotionMatrix timing_covariance;  // see Keyframe
    MotionMatrix covariance;         // of its motion since its reference
    TrackedFrame result;
  };
  std::optional<LastFrame> last_;
  bool wants_reference_ = false;  // the last frame is to become one
  int segment_ = 0;
  int latest_segment_ = 0;
  // Where the segment before ended, as long as it is searched for.
  struct EarlierSegment {
    int reference = -1;    // its last
    Rigid3d cur_from_ref;  // of its last pose
    double left_at = 0.0;  // time stamp of the first frame of the new one, s
  };
  std::optional<EarlierSegment> earlier_segment_;
  bool is_lost_ = false;
  bool is_unconnected_ = false;  // the last frame started a segment
  bool is_predicted_ = false;    // see TrackedFrame
};

}  // namespace rgbd_pose
