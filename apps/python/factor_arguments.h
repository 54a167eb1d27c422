#pragma once

#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "apps/python/arrays.h"
#include "core/factors/sqrt_information.h"
#include "core/util/input_error.h"

// Measurements from arguments of Python, mostly of factors. All throw
// InputError with the name of the argument.

namespace rgbd_pose {

// N finite numbers.
template <int N>
Eigen::Matrix<double, N, 1> VectorFrom(const pybind11::object& object,
                                       const std::string& name) {
  const NumberArray numbers(object, name, {N});
  Eigen::Matrix<double, N, 1> vector;
  for (int i = 0; i < N; ++i) vector[i] = numbers(i);
  if (!vector.allFinite()) throw InputError(name + ": is not finite");
  return vector;
}

// A direction of any length, as one of length 1.
inline Eigen::Vector3d DirectionFrom(const pybind11::object& object,
                                     const std::string& name) {
  const Eigen::Vector3d direction = VectorFrom<3>(object, name);
  if (!(direction.norm() > 0.0)) {
    throw InputError(name + ": has no length, so it is no direction");
  }
  return direction.normalized();
}

inline double Positive(double value, const std::string& name) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InputError(name + ": must be a positive number");
  }
  return value;
}

inline double Finite(double value, const std::string& name) {
  if (!std::isfinite(value)) throw InputError(name + ": is not finite");
  return value;
}

// A symmetric matrix.
template <int N>
Eigen::Matrix<double, N, N> SymmetricFrom(const pybind11::object& object,
                                          const std::string& name) {
  const NumberArray numbers(object, name, {N, N});
  const Eigen::Matrix<double, N, N> matrix =
      Eigen::Matrix<double, N, N>::NullaryExpr(
          [&](int i, int j) { return numbers(i, j); });
  const Eigen::VectorXd size = matrix.diagonal().cwiseAbs().cwiseSqrt();
  const Eigen::MatrixXd rounding = 1e-6 * size * size.transpose();
  // The negated condition also rejects NaN.
  if (!((matrix - matrix.transpose()).cwiseAbs().array() <= rounding.array())
           .all()) {
    throw InputError(name + ": is not finite and symmetric");
  }
  return matrix;
}

// S with S^T S = covariance^-1, of an argument named `covariance`.
template <int N>
Eigen::Matrix<double, N, N> SqrtInformationFrom(
    const pybind11::object& covariance) {
  const std::string name = "covariance";
  const auto matrix = SymmetricFrom<N>(covariance, name);
  return Located(name, [&] { return SqrtInformationOfCovariance(matrix); });
}

}  // namespace rgbd_pose
