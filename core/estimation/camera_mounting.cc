#include "core/estimation/camera_mounting.h"

namespace rgbd_pose {

Rigid3d CameraMotion(const Rigid3d& body_from_cam, const Rigid3d& body_motion) {
  return body_from_cam.Inverse() * body_motion * body_from_cam;
}

MotionMatrix CameraMotionJacobian(const Rigid3d& body_from_cam,
                                  const Rigid3d& body_motion) {
  const Eigen::Matrix3d cam_from_body =
      body_from_cam.rotation.toRotationMatrix().transpose();
  const Eigen::Matrix3d prev_from_cur =
      body_motion.rotation.toRotationMatrix().transpose();
  MotionMatrix jacobian = MotionMatrix::Zero();
  jacobian.topLeftCorner<3, 3>() = cam_from_body;
  jacobian.bottomRightCorner<3, 3>() = cam_from_body;
  jacobian.bottomLeftCorner<3, 3>() =
      cam_from_body * prev_from_cur * CrossMatrix(body_from_cam.translation);
  return jacobian;
}

}  // namespace rgbd_pose
