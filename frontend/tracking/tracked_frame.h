#pragma once

#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"

namespace rgbd_pose {

// Whether to believe the pose of a frame.
enum class TrackingStatus {
  kOk,        // a pose that many matches agree on
  kDegraded,  // a pose, but from few or contradicting matches
  kLost,      // no pose was found: see LostPolicy for the one reported
};

// "ok", "degraded", "lost"
const char* ToString(TrackingStatus status);

// What the motion of a frame comes from.
enum class TrackingSource {
  kNone,      // it was not tracked
  kFeatures,  // matches of features
  kDirect,    // pixels alone
  kBoth,      // pixels, from where features led
};

// "", "features", "direct", "features+direct"
const char* ToString(TrackingSource source);

// What became of one input frame.
struct TrackedFrame {
  int index = 0;           // the odometry's own count of frames, from 0
  double timestamp = 0.0;  // s
  TrackingStatus status = TrackingStatus::kLost;  // with its reason:
  std::string reason;                             // in words; empty if ok

  Rigid3d world_from_cam;  // the world is the camera of the first frame

  // Frames of one segment hang together. A new one starts where tracking was
  // lost, at constant velocity from the last pose: what happened between is
  // unknown. As long as the one before is searched for, poses are `degraded`;
  // where a frame is found in it, its edges join both.
  int segment = 0;

  int reference = -1;  // index of the frame its motion counts from; -1: none
  Rigid3d cur_from_reference;  // the motion since then
  bool is_reference = false;   // became the reference of the frames that follow
  bool relocalised = false;    // found again among earlier references

  // The frame before has become a reference, from which this one's motion
  // counts. Its images: see Odometry::FindKeyframe.
  bool previous_is_reference = false;

  // Lost, but the pose follows what others say of the motion since it was not
  // (the motion guess of Odometry::Track).
  bool is_predicted = false;

  // The motions that it was tracked by, their frames named by their index: the
  // first leads to what it was tracked against; a second, where the reference
  // changes to an earlier one, leads to the one that was left. Of a predicted
  // frame, the prediction, less certain with every frame. None where no motion
  // is known or not how certain it is.
  std::vector<RelativePose> edges;

  // What its motion comes from.
  TrackingSource source = TrackingSource::kNone;

  int matches = 0;     // with the reference: of features, or pixels
  int inliers = 0;     // of these, in agreement with the motion
  int iterations = 0;  // of the solver, all attempts together
  double sigma = 0.0;  // spread of whitened residuals; ideally 1

  // Where the time went. Decoding may run beside the tracking of others.
  double decode_ms = 0.0;
  double track_ms = 0.0;       // all of Odometry::Track
  double match_ms = 0.0;       // of it: matching
  double solve_ms = 0.0;       // of it: motion estimation
  double reference_ms = 0.0;   // of it: features of a new reference
  double relocalise_ms = 0.0;  // of it: search for the place when lost
};

}  // namespace rgbd_pose
