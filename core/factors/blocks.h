#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>

#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"

// The parameter blocks of factors (core/factors/factor.h), as Ceres has them.
//
// A Jacobian by hand is taken in the tangent of a block: by small changes that
// are free of constraints. For a pose they are [omega p]: omega (rad) turns the
// body about its own axes, p (m) moves it along the axes of the world,
//
//   R(omega) = R Exp(omega),   position(p) = position + p.
//
// Lift turns such a Jacobian into one by the numbers of the block, which Ceres
// expects. It is exact under any manifold of unit quaternions, PoseManifold or
// Ceres' own.

namespace rgbd_pose {

// A Jacobian in the tangent of one block.
template <int kRows, typename Block>
using TangentJacobian = Eigen::Matrix<double, kRows, Block::kTangent>;

// A pose as the numbers of its block.
using PoseVector = Eigen::Matrix<double, 7, 1>;

// world_from_body for any scalar (double or ceres::Jet).
template <typename T>
struct PoseOf {
  Eigen::Quaternion<T> q;    // turns the body's axes into the world's
  Eigen::Matrix<T, 3, 1> p;  // the body's origin in the world, m

  // q as a matrix.
  Eigen::Matrix<T, 3, 3> R() const { return q.toRotationMatrix(); }
};

// A pose, world_from_body, as [qx qy qz qw x y z]. A quaternion of any length
// but 0 stands for the rotation of the unit quaternion along it; 0 is NaN, so
// that a solver reports a pose that nobody has set.
struct PoseBlock {
  static constexpr char kName[] = "pose";  // for messages
  static constexpr int kSize = 7;          // numbers in the block
  static constexpr int kTangent = 6;       // dimensions of the tangent

  // The pose of the block.
  template <typename T>
  static PoseOf<T> Read(const T* x) {
    Eigen::Quaternion<T> q(x[3], x[0], x[1], x[2]);
    q.coeffs() /= q.norm();  // normalize() would leave 0 as it is
    return {q, {x[4], x[5], x[6]}};
  }

  // d x / d[omega p] for a quaternion of length 1.
  static Eigen::Matrix<double, 7, 6> PlusJacobian(const double* x);

  // Writes kRows x 7 numbers, row by row.
  template <int kRows>
  static void Lift(const TangentJacobian<kRows, PoseBlock>& by, const double* x,
                   double* jacobian) {
    const double squared = Eigen::Map<const Eigen::Vector4d>(x).squaredNorm();
    Eigen::Map<Eigen::Matrix<double, kRows, 7, Eigen::RowMajor>> J(jacobian);
    // The pseudo-inverse of PlusJacobian: its columns are orthogonal.
    J.template leftCols<4>().noalias() = by.template leftCols<3>() *
                                         (2.0 / squared) *
                                         HalfAngleJacobian(x).transpose();
    J.template rightCols<3>() = by.template rightCols<3>();
  }

  // x moved by d[omega p].
  static void Plus(const double* x, const double* d, double* moved);

  // The d[omega p] that moves x to y.
  static Eigen::Matrix<double, 6, 1> Minus(const double* y, const double* x);

  // A direction of the tangent in words.
  static std::string NameOf(int tangent);

  // A pose of the size of a scene, for checks.
  static PoseVector Random(FactorSampler* random);

 private:
  // d q / d(omega / 2) = q * (omega / 2, 0).
  static Eigen::Matrix<double, 4, 3> HalfAngleJacobian(const double* q);
};

// A rigid motion as the numbers of its block.
PoseVector PoseVectorOf(const Rigid3d& world_from_body);
// The same motion, as factors read it.
PoseOf<double> PoseFrom(const Rigid3d& world_from_body);
// The motion of a block.
Rigid3d RigidOf(const PoseVector& pose);

// N numbers without constraints; they are their own tangent.
template <int N>
struct VectorBlock {
  static constexpr char kName[] = "vector";  // for messages
  static constexpr int kSize = N;            // numbers in the block
  static constexpr int kTangent = N;         // dimensions of the tangent

  // The numbers of the block.
  template <typename T>
  static Eigen::Matrix<T, N, 1> Read(const T* x) {
    return Eigen::Map<const Eigen::Matrix<T, N, 1>>(x);
  }

  // d x / d tangent: the identity.
  static Eigen::Matrix<double, N, N> PlusJacobian(const double* /*x*/) {
    return Eigen::Matrix<double, N, N>::Identity();
  }

  // Writes kRows x N numbers, row by row.
  template <int kRows>
  static void Lift(const Eigen::Matrix<double, kRows, N>& by,
                   const double* /*x*/, double* jacobian) {
    for (int row = 0; row < kRows; ++row) {
      for (int k = 0; k < N; ++k) jacobian[row * N + k] = by(row, k);
    }
  }

  // x moved by d.
  static void Plus(const double* x, const double* d, double* moved) {
    for (int k = 0; k < N; ++k) moved[k] = x[k] + d[k];
  }

  // A direction of the tangent in words.
  static std::string NameOf(int k) { return "number " + std::to_string(k); }

  // A value of the size of a scene, for checks.
  static Eigen::Matrix<double, N, 1> Random(FactorSampler* random) {
    return random->Vector<N>(1.0);
  }
};

// The velocity of a body in its own axes: [angular (rad/s), linear (m/s)], as
// in Twist (core/geometry/twist.h).
struct TwistBlock : VectorBlock<6> {
  static constexpr char kName[] = "twist";  // for messages

  // A number of the block in words.
  static std::string NameOf(int k);
};

// The inverse of a depth along an optical axis, 1/m.
struct InverseDepthBlock : VectorBlock<1> {
  static constexpr char kName[] = "inverse depth";  // for messages

  // Its only number in words.
  static std::string NameOf(int /*k*/) { return "1/z"; }
};

// The blocks of a factor, in their order.
template <typename... Blocks>
struct BlockList {};

}  // namespace rgbd_pose
