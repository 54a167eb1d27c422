#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

// Arithmetic shared by the residuals, for double, ceres::Jet, vectors of
// doubles (core/util/vector_lanes.h) and mixes of them. Always inlined: a call
// here, once GCC's inlining budget has run out, makes a whole solve slower by
// half. Other functions return results through pointers: how vectors are
// returned depends on the instruction set.

namespace rgbd_pose {

// Functions that return vectors are always inlined: no calling convention
// applies. The warning stays off: their callers would get it, too.
#pragma GCC diagnostic ignored "-Wpsabi"

// The standard functions for all scalar types. A residual outside this
// namespace writes `using rgbd_pose::log;` instead of `using std::log;`, as a
// vector of doubles belongs to no namespace that would be searched.
template <typename T>
constexpr bool kIsLanes = !std::is_arithmetic_v<T> && !std::is_class_v<T>;

#define RGBD_POSE_LANE_FUNCTION(f)                              \
  using std::f;                                                 \
  template <typename T, std::enable_if_t<kIsLanes<T>, int> = 0> \
  [[gnu::always_inline]] inline T f(const T& x) {               \
    T y = x;                                                    \
    for (size_t i = 0; i < sizeof(T) / sizeof(double); ++i) {   \
      y[i] = std::f(x[i]);                                      \
    }                                                           \
    return y;                                                   \
  }
RGBD_POSE_LANE_FUNCTION(abs)
RGBD_POSE_LANE_FUNCTION(sqrt)
RGBD_POSE_LANE_FUNCTION(cbrt)
RGBD_POSE_LANE_FUNCTION(exp)
RGBD_POSE_LANE_FUNCTION(log)
RGBD_POSE_LANE_FUNCTION(sin)
RGBD_POSE_LANE_FUNCTION(cos)
RGBD_POSE_LANE_FUNCTION(tan)
RGBD_POSE_LANE_FUNCTION(asin)
RGBD_POSE_LANE_FUNCTION(acos)
RGBD_POSE_LANE_FUNCTION(atan)
RGBD_POSE_LANE_FUNCTION(tanh)
#undef RGBD_POSE_LANE_FUNCTION

// Functions of two arguments, one of which may be a number for all lanes (or
// for a Jet, where Ceres lacks this). NOLINTBEGIN(bugprone-macro-parentheses)
#define RGBD_POSE_LANE_FUNCTION(f, mixes)                       \
  using std::f;                                                 \
  template <typename T, std::enable_if_t<kIsLanes<T>, int> = 0> \
  [[gnu::always_inline]] inline T f(const T& x, const T& y) {   \
    T z = x;                                                    \
    for (size_t i = 0; i < sizeof(T) / sizeof(double); ++i) {   \
      z[i] = std::f(x[i], y[i]);                                \
    }                                                           \
    return z;                                                   \
  }                                                             \
  template <typename T, std::enable_if_t<mixes<T>, int> = 0>    \
  [[gnu::always_inline]] inline T f(const T& x, double y) {     \
    return f(x, T(T{} + y));                                    \
  }                                                             \
  template <typename T, std::enable_if_t<mixes<T>, int> = 0>    \
  [[gnu::always_inline]] inline T f(double x, const T& y) {     \
    return f(T(T{} + x), y);                                    \
  }
template <typename T>
constexpr bool kIsNoNumber = !std::is_arithmetic_v<T>;
RGBD_POSE_LANE_FUNCTION(pow, kIsLanes)
RGBD_POSE_LANE_FUNCTION(atan2, kIsNoNumber)
RGBD_POSE_LANE_FUNCTION(hypot, kIsNoNumber)
#undef RGBD_POSE_LANE_FUNCTION  // NOLINTEND(bugprone-macro-parentheses)

// The larger of x and `lowest`, lane by lane.
template <typename T>
[[gnu::always_inline]] inline void Max(const T& x, double lowest, T* result) {
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
