#pragma once

#include <functional>
#include <utility>

#include "core/estimation/motion_estimate.h"
#include "core/geometry/rigid3.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/tracked_frame.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Tracks one frame in several ways and keeps the best of them. A result's times
// and iterations add up.
class TrackingAttempts {
 public:
  using Accept = std::function<bool()>;

  // `tracker` must outlive this.
  explicit TrackingAttempts(Tracker* tracker)
      : tracker_(tracker),
        tracked_(tracker->images().camera),
        other_(tracked_),
        stashed_(tracked_) {}

  // Against a keyframe from one guess; true if the result is a pose.
  bool Try(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
           const TrackingGuess& guess, TrackedFrame* result);

  // The same from two guesses: the second counts where the first leads to no
  // pose, or to a doubtful one and itself to a good one. The slow methods of
  // the tracker are used only if neither guess leads to a good pose without.
  bool TryEither(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
                 const TrackingGuess& first, const TrackingGuess& second,
                 TrackedFrame* result);

  // Another one after a pose was found: it counts if it is good and accepted
  // (asked when kept() is the new one). False, and nothing has changed but the
  // times, if not.
  bool TryFallback(const PreparedFrame& frame, const OdometryKeyframe& keyframe,
                   const TrackingGuess& guess, TrackedFrame* result,
                   const Accept& accept = nullptr);

  // Keeps what counts during another attempt, and restores it.
  void Stash() { std::swap(tracked_, stashed_); }
  void RestoreStashed() { std::swap(tracked_, stashed_); }

  // What the tracker said of the attempt that counts.
  const TrackingResult& kept() const { return tracked_; }
  TrackingResult* mutable_kept() { return &tracked_; }

 private:
  Tracker* tracker_;
  TrackingResult tracked_;
  TrackingResult other_;    // scratch result
  TrackingResult stashed_;  // see Stash
};

}  // namespace rgbd_pose
