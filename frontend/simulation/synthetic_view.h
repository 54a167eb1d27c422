#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {

// A face as a camera sees it. For the ray (x, y, 1) of a pixel in camera axes
// face_from_ray * ray = (u, v, 1) / z: where it meets the face's plane, and the
// inverse of the depth there. All of it is linear in the ray, which makes the
// search for the nearest face a matter of multiplying and comparing.
struct VisibleFace {
  const SceneFace* face = nullptr;
  Eigen::Matrix3f face_from_ray;
  Eigen::Vector3f lamp;    // along u, along v, above the face (m)
  Eigen::Vector3f camera;  // likewise
  Eigen::Vector2f min;     // range of the face on the plane z = 1; without end
  Eigen::Vector2f max;     // where it reaches behind the camera
};

// The faces of a scene whose front is turned to the camera and which are not
// wholly behind it. They point into `scene`.
std::vector<VisibleFace> FindVisibleFaces(const Scene& scene,
                                          const Rigid3d& world_from_cam);

}  // namespace rgbd_pose
