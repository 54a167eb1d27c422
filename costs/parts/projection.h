#pragma once

#include "core/util/lane_math.h"

namespace rgbd_pose {

// Nearer than any depth camera measures, m.
constexpr double kNearestDepth = 0.1;

// The projection of a point q into a camera: m = (a, b, w) with
//
//   a = q_x w = (u - cx) / fx,  b = q_y w = (v - cy) / fy,  w = 1 / q_z.
//
// Nearer than z0 = kNearestDepth and behind the camera, the inverse depth
// continues along its tangent, w = (2 z0 - q_z) / z0^2. It is finite, has a
// continuous derivative and grows the farther a point lies behind. So no motion
// gains by moving points behind the camera, where -q would give the same image.
// T is double, ceres::Jet or a vector of doubles.
template <typename T>
class Projection {
 public:
  // q[3] must outlive the projection.
  explicit Projection(const T* q) : q_(q) {
    T z;
    Max(q[2], kNearestDepth, &z);
    const T inverse = 1.0 / z;
    m_[2] = inverse * (2.0 - q[2] * inverse);
    m_[0] = q[0] * m_[2];
    m_[1] = q[1] * m_[2];
    slope_ = -inverse * inverse;
  }

  const T* m() const { return m_; }

  // dm for a small dq.
  void Derivative(const T* dq, T* dm) const {
    dm[2] = slope_ * dq[2];
    dm[0] = m_[2] * dq[0] + q_[0] * dm[2];
    dm[1] = m_[2] * dq[1] + q_[1] * dm[2];
  }

 private:
  const T* q_;
  T m_[3];
  T slope_;  // dw / dq_z
};

}  // namespace rgbd_pose
