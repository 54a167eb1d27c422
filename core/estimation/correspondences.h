#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// One match seen from one of its two frames.
struct Observation {
  double u = 0.0;            // ideal (undistorted) pixel, px
  double v = 0.0;            // ideal (undistorted) pixel, px
  double depth = 0.0;        // along the optical axis, m; 0 = not measured
  double sigma_px = 0.5;     // standard deviation of u and of v, px
  double sigma_depth = 0.0;  // standard deviation of depth, m
  // Unit normal of the surface in camera axes; zero = not known.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

// All matches seen from one frame, as a structure of arrays.
class ObservationArray {
 public:
  // As those of std::vector.
  size_t size() const { return u_.size(); }
  void reserve(size_t n);
  void clear();
  void push_back(const Observation& observation);
  Observation operator[](size_t i) const {
    return {u_[i],        v_[i],           depth_[i],
            sigma_px_[i], sigma_depth_[i], {nx_[i], ny_[i], nz_[i]}};
  }

 private:
  // Calls f with every column.
  template <typename F>
  void ForEachColumn(F f) {
    for (auto* column :
         {&u_, &v_, &depth_, &sigma_px_, &sigma_depth_, &nx_, &ny_, &nz_}) {
      f(column);
    }
  }

  std::vector<double> u_, v_, depth_, sigma_px_, sigma_depth_, nx_, ny_, nz_;
};

// Matches between a previous and a current frame of one pinhole camera.
class Correspondences {
 public:
  Correspondences() = default;
  // Only fx, fy, cx, cy of the camera count: pixels are undistorted.
  explicit Correspondences(const Camera& camera) : camera_(camera) {}

  // Adds a match if all of its numbers are finite, its sigmas are positive
  // (that of a depth only where there is a depth) and its depths not negative;
  // counts it as rejected otherwise. Returns whether it was added.
  bool Add(const Observation& prev, const Observation& cur);

  // Takes all matches out; keeps the memory and the camera.
  void Clear();
  void Reserve(size_t n);

  // How many matches there are, and how many Add has refused.
  size_t size() const { return prev_.size(); }
  size_t rejected() const { return rejected_; }

  // What both sides share, and what each has seen, in the same order.
  const Camera& camera() const { return camera_; }
  const ObservationArray& prev() const { return prev_; }
  const ObservationArray& cur() const { return cur_; }

  // Point in camera axes (m) of an observation with a depth.
  Eigen::Vector3d Point(const Observation& o) const {
    return {(o.u - camera_.cx) / camera_.fx * o.depth,
            (o.v - camera_.cy) / camera_.fy * o.depth, o.depth};
  }

 private:
  Camera camera_;
  ObservationArray prev_;
  ObservationArray cur_;
  size_t rejected_ = 0;
};

}  // namespace rgbd_pose
