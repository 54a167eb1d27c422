#pragma once

#include <memory>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"
#include "frontend/places/relocaliser.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// A frame that others are tracked against, and all that is kept of it.
struct Keyframe {
  int id = 0;       // TrackedFrame::index of the frame
  int segment = 0;  // see TrackedFrame
  Rigid3d world_from_cam;
  std::unique_ptr<Reference> reference;  // for the tracker that made it
  std::unique_ptr<Place> place;          // for the relocaliser
  std::vector<RelativePose> edges;       // to keyframes it was tracked against
  // What the uncertainty of its velocity adds to that of motions from it.
  MotionMatrix velocity_covariance = MotionMatrix::Zero();
};

// The latest keyframes, for when the view returns to one of them. Bounded: the
// oldest makes way.
class Keyframes {
 public:
  // So many are kept: some seconds of fast motion; up to 1.5 MB each.
  static constexpr size_t kMaxKeyframes = 20;

  // The keyframe stays where it is as long as it is kept. `in_use` does not
  // make way; may be null.
  Keyframe* Add(Keyframe keyframe, const Keyframe* in_use = nullptr);

  // Makes a kept keyframe the latest.
  void Renew(const Keyframe* keyframe);

  // The keyframe of that id, or null if it is not kept.
  Keyframe* Find(int id) const;

  // Those of segments before that one as places, the latest first.
  std::vector<Place*> PlacesBefore(int segment) const;

  // The keyframe of that segment whose view a camera at `world_from_cam` should
  // see nearest to where it was; null if none has `min_share` of it in view
  // within `max_flow_px` on average. `except` is left out.
  Keyframe* FindNearest(const Rigid3d& world_from_cam, int segment,
                        double min_share, double max_flow_px,
                        const Keyframe* except) const;

 private:
  std::vector<std::unique_ptr<Keyframe>> keyframes_;  // the oldest first
};

}  // namespace rgbd_pose
