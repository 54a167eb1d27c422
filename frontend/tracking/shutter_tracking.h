#pragma once

#include <functional>
#include <optional>

#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/tracker.h"
#include "frontend/tracking/velocity_prior.h"
#include "frontend/tracking/velocity_smoothing.h"

namespace rgbd_pose {

// A reference whose velocity the next frame will determine. It is not nested in
// ShutterTracking because clang 14 fails there.
struct EarlyReference {
  Frame frame;  // without images
  // As it was found with the pose; nothing: the pose was found without a
  // velocity, so it is valid at the stamp.
  std::optional<TwistEstimate> velocity;
  MotionMatrix motion_covariance;  // see CovarianceInCurrentAxes
  std::optional<Twist> before;     // mean velocity in the interval before it
  double interval = 0.0;           // length of this interval, s
  MotionMatrix timing_covariance;  // of the reference, as first known
};

// Tracks frames whose rows were exposed one after another, or whose depth was
// exposed at another time than colour, with a velocity determined from the rows
// and the previous frames. Where the points of a reference are depends on the
// velocity of its frame, which the next frame makes more accurate. A copy is
// the state between two frames.
class ShutterTracking {
 public:
  // Tracks a frame; `prior`: of its velocity (null: nothing is known). Returns
  // false if it is lost.
  using Track = std::function<bool(const PreparedFrame& frame,
                                   const VelocityPrior* prior)>;
  // Corrects its motion after the reference has moved.
  using TrackAgain =
      std::function<bool(const PreparedFrame& frame, const VelocityPrior& prior,
                         const Rigid3d& cur_from_ref)>;

  // `tracker` must outlive this object.
  explicit ShutterTracking(const Tracker* tracker) : tracker_(tracker) {}

  // Tracks a frame against a reference, `interval` s after the last frame.
  // `prev_from_ref`: motion of the last frame if it was found; `first_guess`:
  // of the velocity, by default the last one; `measured`: the velocity by an
  // inertial sensor, if there is one; `tracked`: what `track` fills.
  // Returns the frame with the velocity found, valid until the next call, or
  // null if it is lost.
  const PreparedFrame* Follow(const PreparedFrame& frame, double interval,
                              const std::optional<Rigid3d>& prev_from_ref,
                              const std::optional<Twist>& first_guess,
                              const std::optional<MeasuredTwist>& measured,
                              OdometryKeyframe* reference,
                              const TrackingResult& tracked, const Track& track,
                              const TrackAgain& track_again);

  // Corrects the result of the last Follow after its pose was refined.
  void Update(const TrackingResult& refined);

  // Accepts the pose of the last Follow, as refined; the next frame continues
  // from it.
  void Accept(const TrackingResult& refined);

  // What the change of velocity that it has seen adds to the covariance of its
  // motion: rows are corrected with a constant velocity.
  const MotionMatrix& acceleration_covariance() const {
    return acceleration_covariance_;
  }

  // Continues from a frame whose pose was found without Follow, after a loss.
  void Restart(const Frame& frame, const TrackingResult& tracked);

  // Call this if the last frame was not found.
  void HandleLost();

  // Forgets the velocity.
  void Forget() {
    velocity_.Reset();
    HandleLost();
  }

  // The velocity, for frames that are tracked without Follow.
  const VelocityModel& velocity() const { return velocity_; }

  // Registers a new reference, made of the last frame that was tracked. Sets
  // its velocity_covariance.
  void AddReference(OdometryKeyframe* reference);

 private:
  // The result of the last Follow.
  struct Found {
    std::optional<PreparedFrame> frame;
    std::optional<VelocityPrior> prior;
    std::optional<TwistEstimate> velocity;
    std::optional<Twist> between;  // mean velocity before the frame
    double interval = 0.0;         // over this interval, s
  };

  void AddVelocity(const Frame& frame, const Twist& twist);
  VelocityPrior PriorOf(const OdometryKeyframe& reference,
                        const std::optional<Rigid3d>& prev_from_ref,
                        const std::optional<MeasuredTwist>& measured,
                        double interval, double middle) const;
  // Moves the reference according to the mean velocity since then.
  // `covariance`: of the motion since then (see CovarianceInCurrentAxes).
  // Returns false, and moves nothing, if that changes hardly anything.
  bool MoveReference(const Twist& since, const MotionMatrix& covariance,
                     double interval, OdometryKeyframe* reference);
  // Returns what these two tell of its velocity and its motion.
  SmoothedFrame SmoothReference(const Twist& since,
                                const MotionMatrix& covariance,
                                double interval) const;

  const Tracker* tracker_;
  VelocityModel velocity_;
  std::optional<Twist> between_;  // mean velocity before the last frame
  double interval_ = 0.0;         // over this interval, s
  std::optional<TwistEstimate> found_velocity_;            // of the last frame
  MotionMatrix motion_covariance_ = MotionMatrix::Zero();  // in its axes
  MotionMatrix acceleration_covariance_ = MotionMatrix::Zero();
  std::optional<EarlyReference> early_;
  Found found_;
};

}  // namespace rgbd_pose
