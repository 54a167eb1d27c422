#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "frontend/slam/keyframe_map.h"

namespace rgbd_pose {

// Image size of maps in tests.
constexpr int kMapWidth = 32;
constexpr int kMapHeight = 24;

// A frame of noise, which needs many bytes; differs for each seed.
inline Frame NoiseFrame(int seed) {
  Frame frame;
  frame.timestamp = 1305031098.6659 + seed / 30.0;
  frame.depth_delay = -1.0 / 70.0;
  frame.gray.create(kMapHeight, kMapWidth, CV_8UC1);
  frame.depth.create(kMapHeight, kMapWidth, CV_16UC1);
  cv::RNG random(seed + 1);
  random.fill(frame.gray, cv::RNG::UNIFORM, 0, 256);
  random.fill(frame.depth, cv::RNG::UNIFORM, 0, 65536);
  return frame;
}

// A map of `keyframes` keyframes in two segments, each joined to the next.
// Every second one knows which way is up. Frames and numbers depend on the seed
// and use all their digits.
inline KeyframeMap NoiseMap(int keyframes, int seed) {
  KeyframeMap map;
  map.camera = {kMapWidth, kMapHeight, 30.1, 29.9, 15.5, 11.5, 0.1, -1.0 / 3.0};
  for (int i = 0; i < keyframes; ++i) {
    const Eigen::Vector3d place =
        Eigen::Vector3d(i + 1.0 / 3.0, -0.0, 1e-300) * M_PI * (1 + seed);
    const Eigen::Quaterniond rotation(0.1 * i + seed, 0.2, -0.3, 0.7);
    const Rigid3d pose(rotation, place);
    const int id = 7 * i - 3;
    map.keyframes.push_back({id,
                             i / 3,
                             pose,
                             {},
                             {},
                             StoredImages(NoiseFrame(100 * seed + i)),
                             MotionMatrix::Constant(i * M_PI)});
    if (i % 2 == 1) {
      map.ups.push_back(
          {id, (rotation.normalized() * Eigen::Vector3d::UnitY()).normalized(),
           0.01 / 3.0});
    }
    if (i % 3 == 0) continue;  // begins a segment
    const MotionMatrix root = MotionMatrix::Identity() / (3.0 + i) +
                              MotionMatrix::Constant(1e-5 * M_PI);
    const MotionMatrix covariance = root * root.transpose() / 7e5;
    map.edges.push_back({{id - 7, id, pose.Inverse(), covariance}, i % 2 == 0});
  }
  return map;
}

inline bool IsSameMotion(const Rigid3d& a, const Rigid3d& b) {
  return a.rotation.coeffs() == b.rotation.coeffs() &&
         a.translation == b.translation;
}

// Compares to the last bit.
inline bool IsSameMap(const KeyframeMap& a, const KeyframeMap& b) {
  if (!a.CheckCamera(b.camera).empty() ||
      a.keyframes.size() != b.keyframes.size() ||
      a.edges.size() != b.edges.size() || a.ups.size() != b.ups.size()) {
    return false;
  }
  for (size_t i = 0; i < a.keyframes.size(); ++i) {
    const Keyframe& x = a.keyframes[i];
    const Keyframe& y = b.keyframes[i];
    if (x.id != y.id || x.segment != y.segment ||
        !IsSameMotion(x.world_from_cam, y.world_from_cam) ||
        x.images.timestamp != y.images.timestamp ||
        x.images.depth_delay != y.images.depth_delay ||
        x.images.depth_scale != y.images.depth_scale ||
        x.timing_covariance != y.timing_covariance ||
        x.images.gray->bytes != y.images.gray->bytes ||
        x.images.depth->bytes != y.images.depth->bytes) {
      return false;
    }
  }
  for (size_t i = 0; i < a.edges.size(); ++i) {
    const MapEdge& x = a.edges[i];
    const MapEdge& y = b.edges[i];
    if (x.is_tracked != y.is_tracked || x.ref != y.ref || x.cur != y.cur ||
        !IsSameMotion(x.cur_from_ref, y.cur_from_ref) ||
        x.covariance != y.covariance) {
      return false;
    }
  }
  for (size_t i = 0; i < a.ups.size(); ++i) {
    const MapUp& x = a.ups[i];
    const MapUp& y = b.ups[i];
    if (x.keyframe != y.keyframe || x.in_cam != y.in_cam ||
        x.sigma != y.sigma) {
      return false;
    }
  }
  return true;
}

}  // namespace rgbd_pose
