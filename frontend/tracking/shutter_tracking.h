#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/frame/frame_rectifier.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/tracker.h"
#include "frontend/tracking/velocity_prior.h"

namespace rgbd_pose {

// A reference whose velocity the next frame will tell. Not within
// ShutterTracking: clang 14 fails there.
struct EarlyReference {
  Frame frame;                 // as exposed
  Rigid3d target_from_middle;  // the camera that it is resampled for
  bool is_free = false;  // its pose came without a velocity: it is the stamp's
  bool is_late = false;  // the next frame has told its velocity already
  std::optional<Twist> before;  // the mean velocity into it
  double interval = 0.0;        // of that, s
};

// Tracks frames whose rows were exposed one after another, or whose depth was
// not taken when colour was: with the velocity that their rows and the frames
// before tell. A frame becomes a reference as seen at one moment, with a
// velocity that is known better once the next frame is.
class ShutterTracking {
 public:
  // Tracks a frame with what is known of its velocity (null: nothing) from
  // where it was found before (null: it was not yet); null: it is lost.
  using Track = std::function<const TrackingResult*(
      const PreparedFrame& frame, const VelocityPrior* prior,
      const Rigid3d* cur_from_ref)>;

  // `tracker` must outlive this.
  explicit ShutterTracking(Tracker* tracker)
      : tracker_(tracker), rectifier_(tracker->images().camera) {}

  // Tracks a frame against a reference, `interval` s after the last frame.
  // `prev_from_ref`: of that, nothing: it was not found; `first_guess`: of the
  // velocity, nothing: that of the last frame. The frame with the velocity
  // found, good until the next call; null if it is lost.
  const PreparedFrame* Follow(const PreparedFrame& frame, double interval,
                              const std::optional<Rigid3d>& prev_from_ref,
                              const std::optional<Twist>& first_guess,
                              OdometryKeyframe* reference, const Track& track);

  // The frame of the last Follow has that pose: the next one goes on from it.
  void Accept();

  // A frame that was found elsewhere had that velocity.
  void Accept(const Twist& twist, double middle) {
    velocity_.Add(twist, middle);
  }

  // The last frame was not found.
  void HandleLost();

  // Nothing is known of the velocity any more.
  void Forget() {
    velocity_.Reset();
    HandleLost();
  }

  // What the last Follow has found, to be put back after another one.
  struct Found {
    std::optional<PreparedFrame> frame;
    std::optional<Twist> between;  // the mean velocity into it
    double interval = 0.0;         // of that, s
  };
  Found TakeFound() { return std::move(found_); }
  void PutBack(Found found) { found_ = std::move(found); }

  // What is known of the velocity of a frame whose last ones were not found.
  VelocityPrior LostPrior(const Frame& frame, double interval) const {
    return velocity_.Prior(std::nullopt, interval, frame.color_shutter.offset);
  }

  // A frame of Follow, or one whose velocity is not known, as it is to become a
  // reference: seen at one moment.
  PreparedFrame AtOneMoment(const Frame& frame);

  // The same of the frame before that of the last Follow, which has told its
  // velocity, too, if it was found.
  PreparedFrame LastAtOneMoment(const Frame& last);

  // The frame, which AtOneMoment has moved, is a reference now.
  void AddReference(const Frame& frame, const Frame& at_one_moment);

 private:
  PreparedFrame Rectified(Frame frame, const Rigid3d& target_from_middle);
  // Makes the reference again with the mean velocity since; false: there is
  // nothing to gain.
  bool MendReference(const Twist& since, double interval,
                     OdometryKeyframe* reference);

  Tracker* tracker_;
  FrameRectifier rectifier_;
  VelocityModel velocity_;
  std::optional<Twist> between_;  // mean velocity into the last frame
  double interval_ = 0.0;         // of that, s
  std::optional<EarlyReference> early_;
  Found found_;
};

}  // namespace rgbd_pose
