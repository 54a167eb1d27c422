#include <cmath>

#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_renderer.h"

namespace rgbd_pose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

struct WalkingBox {
  SceneBox box;   // in the middle of its way
  Vector3d half;  // from there to either end (m)
  double rate;    // of its phase (rad/s)
  double phase;   // at time 0 (rad)
};

// In front of the desk, behind it, and towards and away from the camera.
const WalkingBox kWalkingBoxes[kMaxWalkingBoxes] = {
    {{{-0.05, 0.0, 0.0}, {0.30, 0.40, 1.25}, 10}, {0.0, 1.1, 0.0}, 0.8, 4.0},
    {{{1.50, 0.1, 0.0}, {0.40, 0.50, 1.50}, -20}, {0.0, 1.2, 0.0}, 0.7, 0.5},
    {{{0.90, -0.8, 0.0}, {0.35, 0.45, 1.40}, 25}, {0.9, 0.2, 0.0}, 0.9, 2.2}};

}  // namespace

SyntheticMover MovingPatch(double share, const Camera& camera,
                           const std::function<Rigid3d(double t)>& path,
                           uint32_t seed) {
  constexpr double kDepth = 1.0;  // m
  // Semi-axes of the ellipse, as shares of the image, and its angular rate
  // (rad/s): 150 to 240 px/s.
  constexpr double kHalfWidth = 100.0 / 640.0;
  constexpr double kHalfHeight = 62.5 / 480.0;
  constexpr double kRate = 2.4;
  const double width = kDepth * camera.width / camera.fx;  // of the view, m
  const double height = kDepth * camera.height / camera.fy;
  SyntheticMover patch;
  SceneFace face;
  face.width = std::sqrt(share) * width;
  face.height = std::sqrt(share) * height;
  face.origin = {-face.width / 2, -face.height / 2, kDepth};
  face.normal = -Vector3d::UnitZ();
  face.material = kPoster;
  face.seed = HashCell(1, 2, seed);
  patch.scene = {{face}, {0.3, -0.3, -1.5}};
  patch.world_from_mover = [path, width, height](double t) {
    return path(t) * Rigid3d(Quaterniond::Identity(),
                             {kHalfWidth * width * std::cos(kRate * t),
                              kHalfHeight * height * std::sin(kRate * t), 0.0});
  };
  return patch;
}

std::vector<SyntheticMover> WalkingBoxes(int count, uint32_t seed) {
  std::vector<SyntheticMover> boxes;
  for (int i = 0; i < count; ++i) {
    const WalkingBox& walking = kWalkingBoxes[i];
    SyntheticMover box;
    box.scene = {{}, {-1.0, 0.3, 2.2}, HashCell(i, 3, seed)};
    AddBox({Vector3d::Zero(), walking.box.size, walking.box.yaw_deg}, kPoster,
           &box.scene);
    box.world_from_mover = [&walking](double t) {
      const double swing = std::sin(walking.rate * t + walking.phase);
      return Rigid3d(Quaterniond::Identity(),
                     walking.box.foot + swing * walking.half);
    };
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace rgbd_pose
