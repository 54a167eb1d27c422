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

// Measures the motion between two keyframes by a Tracker. Keeps the references
// that were used last.
class PairTracker {
 public:
  explicit PairTracker(std::unique_ptr<Tracker> tracker)
      : tracker_(std::move(tracker)), tracked_(tracker_->images().camera) {}

  // Options of the frontend, see Tracker.
  const FrontendOptions& images() const { return tracker_->images(); }

  // The motion from `keyframe` (number `ref`) to `frame` (number `cur`), if it
  // is reliable and near the initial guess.
  std::optional<RelativePose> MakePair(int ref, int cur,
                                       const Keyframe& keyframe,
                                       const PreparedFrame& frame,
                                       const Rigid3d& cur_from_ref_guess,
                                       double min_inlier_share);

  // Drops the reference of a keyframe that is no longer needed.
  void Forget(int keyframe);

 private:
  const Reference* ReferenceOf(int at, const Keyframe& keyframe);

  const std::unique_ptr<Tracker> tracker_;
  // By keyframe number, the last used one first.
  std::list<std::pair<int, std::unique_ptr<Reference>>> references_;
  TrackingResult tracked_;
};

// Whether two motions differ by at most `rotation` (rad) and `translation` (m).
inline bool IsWithin(const Rigid3d& a, const Rigid3d& b, double rotation,
                     double translation) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() <= rotation && moved.translation.norm() <= translation;
}

}  // namespace rgbd_pose
