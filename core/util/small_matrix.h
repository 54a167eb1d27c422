#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace rgbd_pose {

// A matrix of at most 7 x 7 numbers.
using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 7, 7>;

// Eigenvalues, which increase, and eigenvectors of a symmetric matrix. Compiled
// once for all sizes: Eigen's solver takes seconds.
Eigen::SelfAdjointEigenSolver<SmallMatrix> EigenOf(const SmallMatrix& matrix);

}  // namespace rgbd_pose
