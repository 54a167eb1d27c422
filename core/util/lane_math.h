#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

// Arithmetic that residuals share, for double, ceres::Jet and vectors of
// doubles (core/util/vector_lanes.h) and mixes of them. Results come by
// pointer: how vectors are returned depends on the instruction set. Always
// inlined: GCC's budget for it ends within costs/cost_factory.cc, and a call
// here makes a whole solve slower by half.

namespace rgbd_pose {

// The square root, lane by lane.
template <typename T>
[[gnu::always_inline]] inline void Sqrt(const T& x, T* root) {
  if constexpr (std::is_floating_point_v<T> || std::is_class_v<T>) {
    using std::sqrt;
    *root = sqrt(x);
  } else {
    for (size_t lane = 0; lane < sizeof(T) / sizeof(double); ++lane) {
      (*root)[lane] = std::sqrt(x[lane]);
    }
  }
}

// x where it exceeds `lowest`, else `lowest`, lane by lane.
template <typename T>
[[gnu::always_inline]] inline void AtLeast(const T& x, double lowest,
                                           T* result) {
  const T limit = T{} + lowest;
  *result = x > limit ? x : limit;
}

// y = A x.
template <typename M, typename D, typename T>
[[gnu::always_inline]] inline void Multiply(const Eigen::Matrix<M, 3, 3>& A,
                                            const D* x, T* y) {
  for (int i = 0; i < 3; ++i) {
    y[i] = A(i, 0) * x[0] + A(i, 1) * x[1] + A(i, 2) * x[2];
  }
}

// y = A^T x.
template <typename M, typename D, typename T>
[[gnu::always_inline]] inline void MultiplyTransposed(
    const Eigen::Matrix<M, 3, 3>& A, const D* x, T* y) {
  for (int i = 0; i < 3; ++i) {
    y[i] = A(0, i) * x[0] + A(1, i) * x[1] + A(2, i) * x[2];
  }
}

// c = a x b.
template <typename A, typename B, typename T>
[[gnu::always_inline]] inline void Cross(const A* a, const B* b, T* c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

}  // namespace rgbd_pose
