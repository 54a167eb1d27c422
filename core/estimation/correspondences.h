#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// The observation of a match in one of its two frames.
struct Observation {
  double u = 0.0;            // ideal (undistorted) pixel, px
  double v = 0.0;            // ideal (undistorted) pixel, px
  double depth = 0.0;        // along the optical axis, m; 0 = not measured
  double sigma_px = 0.5;     // standard deviation of u and of v, px
  double sigma_depth = 0.0;  // standard deviation of depth, m
  // Unit normal of the surface in camera axes; zero if unknown.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

// One scene point, presumably, seen in both frames.
struct Match {
  Observation prev;  // in the previous frame
  Observation cur;   // in the current frame
};

// Matches between a previous and a current frame of one pinhole camera.
class Correspondences {
 public:
  Correspondences() = default;
  // Only fx, fy, cx, cy of the camera are used: pixels are undistorted.
  explicit Correspondences(const Camera& camera) : camera_(camera) {}

  // Adds a match if all its numbers are finite and below a million, its sigmas
  // are positive (the sigma of a depth only if there is a depth) and its depths
  // are not negative; sigmas and nonzero depths below 1e-9 are invalid.
  // Otherwise counts it as rejected. Returns whether it was added.
  bool Add(const Observation& prev, const Observation& cur);

  // Removes all matches; keeps the memory and the camera.
  void Clear();
  void Reserve(size_t n) { matches_.reserve(n); }

  // The matches, with the interface of a std::vector.
  size_t size() const { return matches_.size(); }
  const Match& operator[](size_t i) const { return matches_[i]; }
  std::vector<Match>::const_iterator begin() const { return matches_.begin(); }
  std::vector<Match>::const_iterator end() const { return matches_.end(); }

  // The number of matches rejected by Add.
  size_t rejected() const { return rejected_; }

  // The camera of both frames.
  const Camera& camera() const { return camera_; }

  // Point in camera axes (m) of an observation with a depth.
  Eigen::Vector3d Point(const Observation& o) const {
    return camera_.Ray(o.u, o.v) * o.depth;
  }

 private:
  Camera camera_;
  std::vector<Match> matches_;
  size_t rejected_ = 0;
};

}  // namespace rgbd_pose
