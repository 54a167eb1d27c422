#pragma once

#include <memory>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/places/keyframe.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// A keyframe that frames are tracked against. Its id: TrackedFrame::index.
struct OdometryKeyframe : Keyframe {
  std::unique_ptr<Reference> reference;  // of the tracker that made it
};

// The latest keyframes, for when the view returns to one of them. Bounded: the
// oldest makes way.
class Keyframes {
 public:
  // So many are kept: some seconds of fast motion; some 3 MB each.
  static constexpr size_t kMaxKeyframes = 20;

  // The keyframe stays where it is as long as it is kept. `in_use` does not
  // make way; may be null.
  OdometryKeyframe* Add(OdometryKeyframe keyframe,
                        const OdometryKeyframe* in_use = nullptr);

  // Makes a kept keyframe the latest.
  void Renew(const OdometryKeyframe* keyframe);

  // The keyframe of that id, or null if it is not kept.
  OdometryKeyframe* Find(int id) const;

  // Those of segments before that one, the latest first.
  std::vector<Keyframe*> Before(int segment) const;

  // The keyframe of that segment whose view a camera at `world_from_cam` should
  // see nearest to where it was; null if none has `min_share` of it in view
  // within `max_flow_px` on average. `except` is left out.
  OdometryKeyframe* FindNearest(const Rigid3d& world_from_cam, int segment,
                                double min_share, double max_flow_px,
                                const OdometryKeyframe* except) const;

 private:
  std::vector<std::unique_ptr<OdometryKeyframe>>
      keyframes_;  // the oldest first
};

}  // namespace rgbd_pose
