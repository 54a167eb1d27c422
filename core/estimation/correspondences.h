#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

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

  // Adds a match if its numbers are finite and below a million, its sigmas
  // above 1e-9 (of a depth only if there is one) and its depths 0 or above
  // 1e-9. Otherwise counts it as rejected. Returns whether it was added.
  bool Add(const Observation& prev, const Observation& cur);

  // Removes all matches; keeps the memory and the camera.
  void Clear() {
    matches_.clear();
    rejected_ = 0;
  }

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

// Knowledge of a motion from a source other than the two frames (wheels, an
// inertial sensor, a motion model). It is a factor of the estimate, not the
// starting point of the solver. Its covariance is taken as exact.
struct MotionPrior {
  Rigid3d mean;  // cur_from_prev

  // Inverse of the covariance of [omega (rad), C (m)] as in MotionEstimate. May
  // be singular: an inertial sensor measures rotation only. Zero, or an invalid
  // information matrix, means that nothing is known.
  MotionMatrix information = MotionMatrix::Zero();
};

}  // namespace rgbd_pose
