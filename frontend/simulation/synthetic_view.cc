#include <limits>

#include "frontend/simulation/synthetic_renderer.h"

namespace rgbd_pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2f;
using Eigen::Vector3d;

constexpr double kNearPlane = 0.01;  // m
constexpr float kEndless = std::numeric_limits<float>::max();

// Fills min and max; false if the face is behind the camera.
bool FindRange(const SceneFace& face, const Vector3d& camera,
               const Matrix3d& cam_from_world_rotation, VisibleFace* visible) {
  visible->min.setConstant(kEndless);
  visible->max.setConstant(-kEndless);
  int corners_in_front = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const double u = (corner & 1) == 0 ? 0.0 : face.width;
    const double v = (corner & 2) == 0 ? 0.0 : face.height;
    const Vector3d in_cam =
        cam_from_world_rotation *
        (face.origin + face.u_axis * u + face.v_axis * v - camera);
    if (in_cam.z() < kNearPlane) continue;
    ++corners_in_front;
    const Vector2f plane = (in_cam.head<2>() / in_cam.z()).cast<float>();
    visible->min = visible->min.cwiseMin(plane);
    visible->max = visible->max.cwiseMax(plane);
  }
  if (corners_in_front < 4) {
    visible->min.setConstant(-kEndless);
    visible->max.setConstant(kEndless);
  }
  return corners_in_front > 0;
}

// A point along u, along v and above the face (m).
Eigen::Vector3f InFaceAxes(const SceneFace& face, const Vector3d& point) {
  const Vector3d from_origin = point - face.origin;
  return Vector3d(face.u_axis.dot(from_origin), face.v_axis.dot(from_origin),
                  face.normal.dot(from_origin))
      .cast<float>();
}

}  // namespace

std::vector<VisibleFace> FindVisibleFaces(const Scene& scene,
                                          const Rigid3d& world_from_cam) {
  const Matrix3d cam_from_world_rotation =
      world_from_cam.rotation.conjugate().toRotationMatrix();
  const Vector3d& camera = world_from_cam.translation;
  std::vector<VisibleFace> faces;
  for (const SceneFace& face : scene.faces) {
    const Vector3d from_origin = camera - face.origin;
    const double above = face.normal.dot(from_origin);
    VisibleFace visible;
    if (above <= 0.0 ||
        !FindRange(face, camera, cam_from_world_rotation, &visible)) {
      continue;
    }
    // A ray r meets the plane at depth z where above + z normal . r = 0.
    Matrix3d rows;
    rows.row(2) = -(cam_from_world_rotation * face.normal) / above;
    rows.row(0) = (cam_from_world_rotation * face.u_axis).transpose() +
                  face.u_axis.dot(from_origin) * rows.row(2);
    rows.row(1) = (cam_from_world_rotation * face.v_axis).transpose() +
                  face.v_axis.dot(from_origin) * rows.row(2);
    visible.face = &face;
    visible.face_from_ray = rows.cast<float>();
    visible.lamp = InFaceAxes(face, scene.lamp);
    visible.camera = InFaceAxes(face, camera);
    faces.push_back(visible);
  }
  return faces;
}

}  // namespace rgbd_pose
