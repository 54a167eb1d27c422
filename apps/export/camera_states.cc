#include "apps/export/camera_states.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

// The covariance of [omega C] of a motion with C in the axes of the current
// camera, too.
MotionMatrix InOwnAxes(const RelativePose& edge) {
  MotionMatrix turned = MotionMatrix::Identity();
  turned.bottomRightCorner<3, 3>() =
      edge.cur_from_ref.rotation.toRotationMatrix();
  return turned * edge.covariance * turned.transpose();
}

}  // namespace

void CameraStates::Add(const StampedPose& pose,
                       const std::optional<RelativePose>& motion,
                       std::optional<MotionMatrix> covariance) {
  const size_t place = path_.size();
  if (!covariance.has_value() && motion.has_value()) {
    const auto ref = static_cast<size_t>(motion->ref);
    if (ref < place && covariances_[ref].has_value()) {
      covariance = ComposedCovariance(motion->cur_from_ref, motion->covariance,
                                      path_[ref].world_from_cam.Inverse(),
                                      *covariances_[ref]);
    }
  }
  path_.push_back(pose);
  motions_.push_back(motion);
  covariances_.push_back(covariance);
}

CameraState CameraStates::At(size_t place) const {
  CameraState state;
  state.pose = path_[place];
  state.covariance = covariances_[place].value_or(MotionMatrix::Zero());
  SetVelocity(place, &state);
  return state;
}

// The covariance: both poses usually have the same reference, so that its own
// error is not in the velocity.
void CameraStates::SetVelocity(size_t place, CameraState* state) const {
  const size_t before = place == 0 ? 0 : place - 1;
  const size_t after = std::min(place + 1, path_.size() - 1);
  const double seconds = path_[after].timestamp - path_[before].timestamp;
  if (!(seconds > 0.0)) return;
  const Rigid3d& start = path_[before].world_from_cam;
  const Rigid3d& end = path_[after].world_from_cam;
  state->twist.angular =
      RotationVector(start.rotation.conjugate() * end.rotation) / seconds;
  state->twist.linear = state->pose.world_from_cam.rotation.conjugate() *
                        (end.translation - start.translation) / seconds;
  MotionMatrix covariance = MotionMatrix::Zero();
  for (const size_t at : {before, after}) {
    if (motions_[at].has_value()) {
      covariance += InOwnAxes(*motions_[at]) / (seconds * seconds);
    } else if (at > 0) {  // The first pose has no motion and no error.
      return;
    }
  }
  state->twist_covariance = covariance;
}

}  // namespace rgbd_pose
