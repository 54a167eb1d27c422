#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/estimation/correspondences.h"

namespace rgbd_pose {

// Covariance (m^2) of the point of an observation with depth, from the noise of
// u, v and depth to first order (Khoshelham & Elberink 2012). With the ray
// (a, b, 1):
//
//   S = z^2 sigma_px^2 diag(1/fx^2, 1/fy^2, 0) + sigma_depth^2 ray ray^T
//
// RayWhitening (bidirectional_point.h) has its inverse square root.
inline Eigen::Matrix3d PointCovariance(const Camera& camera,
                                       const Observation& o) {
  const Eigen::Vector3d ray = camera.Ray(o.u, o.v);
  const Eigen::Vector3d image(o.depth * o.sigma_px / camera.fx,
                              o.depth * o.sigma_px / camera.fy, 0.0);
  Eigen::Matrix3d S = o.sigma_depth * o.sigma_depth * (ray * ray.transpose());
  S.diagonal() += image.cwiseAbs2();
  return S;
}

// r = L^T e has unit covariance: L L^T is the inverse of the covariance of e.
// With the covariance K K^T (Cholesky), L^T = K^-1 is a lower triangle, stored
// row by row; its first part whitens the first n components alone. D is double
// or a vector of doubles.
template <int N>
struct Whitening {
  static constexpr int kColumns = N * (N + 1) / 2;

  template <typename D, typename E, typename T>
  static void Whiten(const D* w, const E* e, T* r) {
    for (int row = 0; row < N; ++row) {
      r[row] = *w++ * e[0];
      for (int k = 1; k <= row; ++k) r[row] += *w++ * e[k];
    }
  }

  // The same for one column of a Jacobian, into rows J[0..N-1].
  template <typename D>
  static void WhitenColumn(const D* w, const D* e, D (*J)[6], int column) {
    D r[N];
    Whiten(w, e, r);
    for (int row = 0; row < N; ++row) J[row][column] = r[row];
  }
};

// Writes the columns of the whitening by a covariance; returns false if it is
// not positive definite. Written out, because some costs do this for every
// match at every motion they are bound to.
template <int N>
bool PackWhitening(const Eigen::Matrix<double, N, N>& covariance,
                   double* columns) {
  double K[N][N], W[N][N];  // K K^T = covariance, W = K^-1; lower triangles
  for (int i = 0; i < N; ++i) {
    double variance = covariance(i, i);
    for (int j = 0; j < i; ++j) {
      double sum = covariance(i, j);
      for (int k = 0; k < j; ++k) sum -= K[i][k] * K[j][k];
      K[i][j] = sum * W[j][j];
      variance -= K[i][j] * K[i][j];
    }
    W[i][i] = 1.0 / std::sqrt(variance);
    if (!(variance > 0.0) || !std::isfinite(W[i][i])) return false;
    for (int j = 0; j < i; ++j) {
      double sum = 0.0;
      for (int k = j; k < i; ++k) sum += K[i][k] * W[k][j];
      W[i][j] = -W[i][i] * sum;
    }
    columns = std::copy_n(W[i], i + 1, columns);
  }
  return std::all_of(columns - Whitening<N>::kColumns, columns,
                     [](double w) { return std::isfinite(w); });
}

// The same for an information matrix: w^T w = information, computed from the
// last row upwards. Returns false if the matrix, which may be singular, is zero
// or not positive semidefinite.
template <int N>
bool PackInformation(const Eigen::Matrix<double, N, N>& information,
                     double* columns) {
  using Matrix = Eigen::Matrix<double, N, N>;
  constexpr double kRounding = 1e-12;
  Matrix rest = information, w = Matrix::Zero();
  for (int row = N - 1; row >= 0; --row) {
    const double pivot = rest(row, row);
    if (pivot > kRounding * information(row, row)) {
      w.row(row).head(row + 1) = rest.row(row).head(row + 1) / std::sqrt(pivot);
      rest -= w.row(row).transpose() * w.row(row);
    }
  }
  const double size = information.norm();
  if (!w.allFinite() || !(size > 0.0) ||
      (w.transpose() * w - information).norm() > 1e-6 * size) {
    return false;
  }
  for (int row = 0; row < N; ++row) {
    for (int k = 0; k <= row; ++k) *columns++ = w(row, k);
  }
  return true;
}

}  // namespace rgbd_pose
