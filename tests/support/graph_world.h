#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "core/geometry/motion.h"
#include "core/pose_graph/pose_graph.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {

// A camera that moves once around a circle and looks outwards.
inline std::vector<Rigid3d> CircleOfPoses(int poses, double radius) {
  std::vector<Rigid3d> circle;
  for (int i = 0; i < poses; ++i) {
    const double angle = 2.0 * M_PI * i / poses;
    const Eigen::Quaterniond heading(
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    circle.emplace_back(heading,
                        heading * Eigen::Vector3d(0.02 * i, 0, radius));
  }
  return circle;
}

// The motion between two poses with random errors, and the covariance of these
// errors (standard deviations in rad and m).
inline RelativePose MeasuredEdge(const std::vector<Rigid3d>& world_from_cam,
                                 int ref, int cur, double sigma_rotation,
                                 double sigma_translation, RandomWorld* world) {
  RelativePose edge;
  edge.ref = ref;
  edge.cur = cur;
  const Rigid3d truth = world_from_cam[cur].Inverse() * world_from_cam[ref];
  Eigen::Vector3d omega, shift;
  for (int i = 0; i < 3; ++i) {
    omega[i] = world->Normal(sigma_rotation);
    shift[i] = world->Normal(sigma_translation);
  }
  const Eigen::Quaterniond rotation =
      Eigen::AngleAxisd(omega.norm(), omega.normalized()) * truth.rotation;
  const Eigen::Vector3d C = truth.Inverse().translation + shift;
  edge.cur_from_ref = Rigid3d(rotation, -(rotation * C));
  edge.covariance.diagonal()
      << Eigen::Vector3d::Constant(std::pow(sigma_rotation, 2)),
      Eigen::Vector3d::Constant(std::pow(sigma_translation, 2));
  return edge;
}

// Root mean square of the distances between poses and the truth, m.
inline double RmsDistance(const PoseGraph& graph,
                          const std::vector<Rigid3d>& truth) {
  double sum = 0.0;
  for (int i = 0; i < graph.num_poses(); ++i) {
    sum += (graph.pose(i).translation - truth[i].translation).squaredNorm();
  }
  return std::sqrt(sum / graph.num_poses());
}

}  // namespace rgbd_pose
