#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/motion.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// What a run tells of the camera at the time of a pose. Covariances are zero
// where they are not known.
struct CameraState {
  StampedPose pose;

  // Of [omega C] of the pose, as in keyframes.csv: relative to the first pose,
  // or to the first keyframe of a map that was loaded.
  MotionMatrix covariance = MotionMatrix::Zero();

  // The mean velocity from the pose before to the one after, in the camera's
  // axes, and the covariance of [angular linear] that follows from both poses.
  Twist twist;
  MotionMatrix twist_covariance = MotionMatrix::Zero();
};

// The states along a path, to which poses are added one by one.
class CameraStates {
 public:
  // `motion`: the measured motion that gave the pose, from an earlier one, both
  // named by their places in the path. `covariance`: that of the pose, if it is
  // known already; otherwise it is composed along the motions.
  void Add(const StampedPose& pose, const std::optional<RelativePose>& motion,
           std::optional<MotionMatrix> covariance);

  // The state of the pose at a place. The velocity changes when the next pose
  // is added; at an end of the path it is that from or to the only neighbour.
  CameraState At(size_t place) const;

  const Trajectory& path() const { return path_; }

 private:
  void SetVelocity(size_t place, CameraState* state) const;

  Trajectory path_;
  // Of each pose, as given to Add or composed.
  std::vector<std::optional<RelativePose>> motions_;
  std::vector<std::optional<MotionMatrix>> covariances_;
};

}  // namespace rgbd_pose
