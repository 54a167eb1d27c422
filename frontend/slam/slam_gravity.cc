#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "frontend/slam/slam.h"

// What Slam does with an accelerometer.

namespace rgbd_pose {

std::map<int, Trajectory> Slam::PathsBySegment() const {
  const Trajectory path = Path();
  const std::vector<int> segments = PathSegments();
  std::map<int, Trajectory> paths;
  for (size_t i = 0; i < path.size(); ++i) {
    paths[segments[i]].push_back(path[i]);
  }
  return paths;
}

void Slam::MeasureUps() {
  const std::map<int, Trajectory> paths = PathsBySegment();
  const GravityEstimate gravity = EstimateGravity(*meter_, paths);
  if (!gravity.ok()) return;
  struct Up {
    int keyframe;
    double stamp;
    Eigen::Vector3d in_cam;
  };
  std::map<int, std::vector<Up>> ups;  // by segment
  std::map<int, size_t> counts;        // of frames, by segment
  std::set<int> seen;
  for (const PathFrame& frame : path_) {
    const int segment = segments_.at(frame.keyframe);
    const size_t at = counts[segment]++;
    // The first frame of a keyframe of this run is that keyframe.
    if (!frame.keyframe_from_cam.IsIdentity()) continue;
    if (!seen.insert(frame.keyframe).second) continue;
    const auto force = meter_->At(paths.at(segment), at);
    if (!force.has_value()) continue;
    ups[segment].push_back(
        {frame.keyframe, frame.timestamp, force->up_in_cam - gravity.bias});
  }
  for (const auto& [segment, all] : ups) {
    for (const Up& up : all) {
      // Means over the same time are wrong alike, and so are all by what is
      // left of the bias. Their sum is as certain as it may be if each of them
      // is so much less certain.
      double overlap = 0.0;
      for (const Up& other : all) {
        overlap += std::max(
            0.0, 1.0 - std::abs(other.stamp - up.stamp) / ForceMeter::kSide);
      }
      const double variance =
          overlap * std::pow(gravity.scatter, 2) +
          static_cast<double>(all.size()) * std::pow(gravity.bias_effect, 2);
      mapper_.SetUp({up.keyframe, up.in_cam.normalized(),
                     std::sqrt(variance) / gravity.acceleration});
    }
  }
}

void Slam::FindGravity() {
  gravity_ = EstimateGravity(*meter_, PathsBySegment());
  const bool has_loaded = first_id_ > 0;
  if (!settings_.upright || !gravity_->ok() || has_loaded) return;
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  upright_from_tracked_ =
      Rigid3d(Eigen::Quaterniond::FromTwoVectors(gravity_->up, z), {0, 0, 0});
  gravity_->up = z;
  SlamFrame unused;
  MapUpdate update = mapper_.MoveAll(upright_from_tracked_);
  update.error = error_;  // of the final optimisation
  Apply(std::move(update), &unused);
}

}  // namespace rgbd_pose
