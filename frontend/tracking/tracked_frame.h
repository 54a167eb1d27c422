#pragma once

#include <string>
#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// How reliable the pose of a frame is.
enum class TrackingStatus {
  kOk,        // a pose on which many matches agree
  kDegraded,  // a pose, but from few or contradicting matches
  kLost,      // no pose was found; LostPolicy says which one is reported
};

// The name printed by programs.
inline const char* ToString(TrackingStatus status) {
  constexpr const char* kNames[] = {"ok", "degraded", "lost"};
  return kNames[static_cast<int>(status)];
}

// What the motion of a frame was estimated from.
enum class TrackingSource {
  kNone,      // it was not tracked
  kFeatures,  // matches of features
  kDirect,    // pixels alone
  kBoth,      // pixels, starting from the motion of the features
  kInertial,  // images show nothing: by the inertial sensor since the last one
};

// The name printed by programs.
inline const char* ToString(TrackingSource source) {
  constexpr const char* kNames[] = {"", "features", "direct", "features+direct",
                                    "inertial"};
  return kNames[static_cast<int>(source)];
}

// The result for one input frame.
struct TrackedFrame {
  int index = 0;           // number of the frame in this odometry, from 0
  double timestamp = 0.0;  // s
  TrackingStatus status = TrackingStatus::kLost;  // see `reason`
  std::string reason;                             // for the status; empty if ok

  Rigid3d world_from_cam;  // the world is the camera of the first frame

  // Poses of one segment are connected. A new segment starts where tracking was
  // lost, at constant velocity from the last pose; the true motion is unknown.
  // While the previous segment is searched for, poses are `degraded`; if a
  // frame is found in it, the edges of this frame connect both segments.
  int segment = 0;

  int reference = -1;          // index of a frame; -1: none; below: of a map
  Rigid3d cur_from_reference;  // motion since the reference
  bool is_reference = false;   // became the reference of the next frames
  bool relocalised = false;    // found again among earlier references

  // The previous frame has become a keyframe, to which the motion of this frame
  // is mostly relative. For its images see Odometry::FindKeyframe.
  bool previous_is_reference = false;

  // The frame is lost, but since the loss the pose follows motion guesses from
  // another source (see Odometry::Track).
  bool is_predicted = false;

  // The motions by which the frame was tracked, between frames named by index.
  // The first edge gives its pose: it leads to its reference or, with
  // previous_is_reference, possibly to the reference before. If the reference
  // changes to an earlier one, a second edge leads to the one that was left.
  // For a predicted frame: the prediction, less certain with every frame. No
  // edges if the motion or its uncertainty is unknown.
  std::vector<RelativePose> edges;

  // What the motion was estimated from.
  TrackingSource source = TrackingSource::kNone;

  int matches = 0;     // with the reference: number of features or pixels
  int inliers = 0;     // of these, number that agree with the motion
  int iterations = 0;  // of the solver, sum over all attempts
  double sigma = 0.0;  // spread of whitened residuals; ideally 1

  // Computing times. Decoding may run in parallel with tracking.
  double decode_ms = 0.0;
  double track_ms = 0.0;       // all of Odometry::Track
  double match_ms = 0.0;       // part of track_ms: matching
  double solve_ms = 0.0;       // part of track_ms: motion estimation
  double reference_ms = 0.0;   // part of track_ms: features of a new reference
  double relocalise_ms = 0.0;  // part of track_ms: search for the place
};

}  // namespace rgbd_pose
