#pragma once

#include <functional>
#include <utility>

#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/tracked_frame.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Tracks one frame in several ways and keeps the best result. Times and
// iterations of all attempts add up.
class TrackingAttempts {
 public:
  using Accept = std::function<bool()>;
  // Finds a motion without a guess, slowly; returns false if there is none.
  using Find = std::function<bool(Rigid3d* cur_from_ref)>;

  // `tracker` must outlive this object.
  explicit TrackingAttempts(Tracker* tracker)
      : tracker_(tracker),
        tracked_(tracker->images().camera),
        other_(tracked_) {}

  // Makes an earlier result count again.
  void Restore(const TrackingResult& kept) { tracked_ = kept; }

  // Tracks against a keyframe from one guess; true if this yields a pose.
  bool Try(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
           const TrackingGuess& guess, TrackedFrame* result);

  // Corrects the result that counts after the keyframe has moved.
  bool TryAgain(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
                const TrackingGuess& guess, TrackedFrame* result);

  // The same from several guesses until one leads to a good pose: the first,
  // the second and, unless the pose is ambiguous, a third from `find`.
  // Otherwise the first pose counts. The slow methods of the tracker are used
  // only if no guess leads to a good pose without them.
  bool TryInTurn(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
                 const TrackingGuess& first, const TrackingGuess& second,
                 const Find& find, TrackedFrame* result);

  // Makes another attempt after a pose was found. It counts if its pose is good
  // and `accept`, called while kept() is the new result, returns true before
  // and after the pose is refined: what is refused takes no time to refine.
  // Otherwise returns false and changes only iterations and times.
  bool TryFallback(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
                   TrackingGuess guess, TrackedFrame* result,
                   const Accept& accept = nullptr);

  // Refines the pose that counts if its attempt has left that.
  void Refine(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
              const TrackingGuess& guess, TrackedFrame* result);

  // The tracker's result of the attempt that counts.
  const TrackingResult& kept() const { return tracked_; }
  TrackingResult* mutable_kept() { return &tracked_; }

 private:
  bool Report(const OdometryKeyframe& keyframe, TrackedFrame* result) const;

  Tracker* tracker_;
  TrackingResult tracked_;
  TrackingResult other_;  // scratch result
};

}  // namespace rgbd_pose
