#pragma once

#include <functional>
#include <optional>

#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/frame/frame_rectifier.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/tracker.h"
#include "frontend/tracking/velocity_prior.h"

namespace rgbd_pose {

// A reference whose velocity the next frame will determine. It is not nested in
// ShutterTracking because clang 14 fails there.
struct EarlyReference {
  Frame frame;                 // as exposed
  Rigid3d target_from_middle;  // of the camera for which it is resampled
  bool is_free = false;  // pose found without velocity: valid at the stamp
  bool is_late = false;  // the next frame has determined its velocity already
  std::optional<Twist> before;     // mean velocity in the interval before it
  double interval = 0.0;           // length of this interval, s
  MotionMatrix timing_covariance;  // of the reference, as first known
};

// Tracks frames whose rows were exposed one after another, or whose depth was
// exposed at another time than colour, with a velocity determined from the rows
// and the previous frames. A frame becomes a reference after correction to one
// moment; the next frame makes the velocity for this more accurate.
class ShutterTracking {
 public:
  // Tracks a frame. `prior`: of its velocity (null: nothing is known);
  // `cur_from_ref`: found before (null: not yet). Returns false if it is lost.
  using Track =
      std::function<bool(const PreparedFrame& frame, const VelocityPrior* prior,
                         const Rigid3d* cur_from_ref)>;

  // `tracker` must outlive this object.
  explicit ShutterTracking(Tracker* tracker)
      : tracker_(tracker), rectifier_(tracker->images().camera) {}

  // Tracks a frame against a reference, `interval` s after the last frame.
  // `prev_from_ref`: motion of the last frame if it was found; `first_guess`:
  // of the velocity, by default the last one; `tracked`: what `track` fills.
  // Returns the frame with the velocity found, valid until the next call, or
  // null if it is lost.
  const PreparedFrame* Follow(const PreparedFrame& frame, double interval,
                              const std::optional<Rigid3d>& prev_from_ref,
                              const std::optional<Twist>& first_guess,
                              OdometryKeyframe* reference,
                              const TrackingResult& tracked,
                              const Track& track);

  // Corrects the result of the last Follow after its pose was refined.
  void Update(const TrackingResult& refined);

  // Accepts the pose of the last Follow; the next frame continues from it.
  void Accept();

  // Call this if the last frame was not found.
  void HandleLost();

  // Forgets the velocity.
  void Forget() {
    velocity_.Reset();
    HandleLost();
  }

  // The result of the last Follow. It can be put back after another Follow.
  struct Found {
    std::optional<PreparedFrame> frame;
    std::optional<VelocityPrior> prior;
    std::optional<Twist> between;  // mean velocity before the frame
    double interval = 0.0;         // over this interval, s
  };
  Found TakeFound() { return std::move(found_); }
  void PutBack(Found found) { found_ = std::move(found); }

  // The velocity, for frames that are tracked without Follow.
  VelocityModel* velocity() { return &velocity_; }

  // Corrects a frame to one moment before it becomes a reference. The frame
  // comes from Follow or has an unknown velocity.
  PreparedFrame AtOneMoment(const Frame& frame);

  // The same for the previous frame, after Follow of the current one. If this
  // was found, the mean velocity between both is used as well.
  PreparedFrame LastAtOneMoment(const Frame& last);

  // Registers a new reference, made of this frame at one moment.
  void AddReference(const Frame& frame, const Keyframe& reference);

 private:
  PreparedFrame Rectified(Frame frame, const Rigid3d& target_from_middle);
  // Rebuilds the reference with the mean velocity since then. Returns false if
  // this has no advantage.
  bool MendReference(const Twist& since, double interval,
                     OdometryKeyframe* reference);

  Tracker* tracker_;
  FrameRectifier rectifier_;
  VelocityModel velocity_;
  std::optional<Twist> between_;  // mean velocity before the last frame
  double interval_ = 0.0;         // over this interval, s
  std::optional<EarlyReference> early_;
  Found found_;
};

}  // namespace rgbd_pose
