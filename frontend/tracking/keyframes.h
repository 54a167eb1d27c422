#pragma once

#include <memory>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/places/keyframe.h"
#include "frontend/tracking/reference.h"

namespace rgbd_pose {

// A keyframe that frames are tracked against. Its id is TrackedFrame::index.
struct OdometryKeyframe : Keyframe {
  std::unique_ptr<Reference> reference;  // made by the tracker in use

  // Covariance of Frame::twist (angular, then linear); 0 without a shutter.
  MotionMatrix velocity_covariance = MotionMatrix::Zero();
};

// The latest keyframes, in case the view returns; the oldest is removed first.
class Keyframes {
 public:
  // Maximum number of keyframes: some seconds of fast motion, about 2 MB each.
  static constexpr size_t kMaxKeyframes = 20;

  // Adds a keyframe; the pointer returned is valid as long as the keyframe is
  // kept. `in_use` (may be null) is never removed here.
  OdometryKeyframe* Add(OdometryKeyframe keyframe,
                        const OdometryKeyframe* in_use = nullptr);

  // Makes a kept keyframe the latest.
  void Renew(const OdometryKeyframe* keyframe);

  // Returns the keyframe with this id, or null if it is not kept.
  OdometryKeyframe* Find(int id) const;

  // Returns the keyframes of earlier segments, the latest first.
  std::vector<Keyframe*> Before(int segment) const;

  // Returns the keyframe of the segment whose view should move least in the
  // image of a camera at `world_from_cam`, or null. At least `min_share` of the
  // view must be visible, moved by at most `max_flow_px` on average. `except`
  // is skipped.
  OdometryKeyframe* FindNearest(const Rigid3d& world_from_cam, int segment,
                                double min_share, double max_flow_px,
                                const OdometryKeyframe* except) const;

 private:
  std::vector<std::unique_ptr<OdometryKeyframe>>
      keyframes_;  // the oldest first
};

}  // namespace rgbd_pose
