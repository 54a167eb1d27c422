#pragma once

#include <list>
#include <memory>
#include <optional>
#include <utility>

#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"
#include "frontend/places/keyframe.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Measures the motion between two keyframes by a Tracker. References of the
// latest keyframes are kept.
class PairTracker {
 public:
  explicit PairTracker(std::unique_ptr<Tracker> tracker)
      : tracker_(std::move(tracker)), tracked_(tracker_->images().camera) {}

  // What images are used for, see Tracker.
  const FrontendOptions& images() const { return tracker_->images(); }

  // The motion from `keyframe`, of number `ref`, to a frame near a guess, if it
  // is a good pair.
  std::optional<RelativePose> MakePair(int ref, int cur,
                                       const Keyframe& keyframe,
                                       const PreparedFrame& frame,
                                       const Rigid3d& cur_from_ref_guess,
                                       double min_inlier_share);

  // The keyframe is not needed any more.
  void Forget(int keyframe);

 private:
  const Reference* ReferenceOf(int at, const Keyframe& keyframe);

  const std::unique_ptr<Tracker> tracker_;
  // References in use, the latest first.
  std::list<std::pair<int, std::unique_ptr<Reference>>> references_;
  TrackingResult tracked_;
};

// Whether two motions differ by no more than a rotation (rad) and a translation
// (m).
inline bool IsWithin(const Rigid3d& a, const Rigid3d& b, double rotation,
                     double translation) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() <= rotation && moved.translation.norm() <= translation;
}

}  // namespace rgbd_pose
