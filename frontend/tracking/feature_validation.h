#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Returns the ideal pixel at which the current camera sees a point observed
// with depth from the reference. The pixel may lie outside the image. Returns
// nothing if the depth is unknown or the point is behind the camera.
inline std::optional<Eigen::Vector2d> SeenAt(const Camera& camera,
                                             const Rigid3d& cur_from_ref,
                                             const Observation& o) {
  if (o.depth <= 0.0) return std::nullopt;
  const Eigen::Vector3d point = cur_from_ref * (camera.Ray(o.u, o.v) * o.depth);
  if (point.z() <= 0.0) return std::nullopt;
  return Eigen::Vector2d(camera.fx * point.x() / point.z() + camera.cx,
                         camera.fy * point.y() / point.z() + camera.cy);
}

// Decides which features of a reference may affect the motion. A robust loss
// follows the majority. With a reference older than the appearance of a moving
// object, the majority is the scene; of a new reference, most features may lie
// on the moving object. Where features of the last reference failed, new ones
// are thus only observed until they have agreed with the motion a few times.
class FeatureValidation {
 public:
  // Trusts all of the given number of features.
  explicit FeatureValidation(size_t features)
      : agreements_needed_(features, 0) {}

  // Puts features of a new reference on probation where those of the last one
  // have failed. `tracked`: the frame of the new reference against the last
  // one. `missing_failed`: features that were not found count as failed. If
  // fewer than `min_trusted` features would be trusted, all are.
  FeatureValidation(const FeatureSet& last, const TrackingResult& tracked,
                    bool missing_failed, const FeatureSet& fresh,
                    size_t min_trusted);

  size_t num_trusted() const;

  // Moves the matches of features on probation from `found` to `on_probation`.
  void Split(FeatureMatches* found, FeatureMatches* on_probation) const;

  // Counts agreements: a feature on probation that agrees with the motion comes
  // closer to being trusted, others start from the beginning.
  void Learn(const FeatureMatches& on_probation, const Rigid3d& cur_from_ref);

 private:
  // How often each feature still has to agree before it is trusted.
  std::vector<int> agreements_needed_;
};

// Returns the number of image cells (64 px) that contain inliers. The scene
// covers more cells than a moving object, even if the object has more features.
int CellsOfInliers(const TrackingResult& tracked);

// Marks in tracked->moving where more features contradict the motion than
// agree; `missing_contradict`: features not found contradict it a little, too.
// Returns in which share of the regions with features some features agree.
double MarkMoving(const FeatureSet& reference, bool missing_contradict,
                  TrackingResult* tracked);

}  // namespace rgbd_pose
