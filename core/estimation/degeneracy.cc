#include "core/estimation/degeneracy.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace rgbd_pose {
namespace {

// Noise of one sigma feigns an information of about 1 a match (rad^-2 or
// m^-2); real scenes at 0.3-8 m give more than 100.
constexpr double kMinInformationPerMatch = 10.0;

constexpr std::array<const char*, 6> kDirections = {
    "rotation about x",    "rotation about y",    "rotation about z",
    "translation along x", "translation along y", "translation along z"};

std::string Describe(const MotionVector& direction, double deviation) {
  Eigen::Index strongest = 0;
  direction.cwiseAbs().maxCoeff(&strongest);
  std::string text = kDirections[strongest];
  for (int i = 0; i < 6; ++i) {
    if (i != strongest && std::abs(direction[i]) > 0.4) {
      text += std::string(" with ") + kDirections[i];
    }
  }
  char number[64];
  std::snprintf(number, sizeof(number), "%.2g %s", deviation,
                strongest < 3 ? "rad" : "m");
  return text + " is not determined (standard deviation " + number + ")";
}

}  // namespace

Degeneracy FindDegeneracy(const MotionMatrix& hessian, double total_weight,
                          double max_standard_deviation) {
  Degeneracy result;
  if (!hessian.allFinite()) {
    result.is_degenerate = true;
    result.reason = "the Hessian is not finite";
    return result;
  }
  const Eigen::SelfAdjointEigenSolver<MotionMatrix> eigen(hessian);
  const double weakest = std::max(eigen.eigenvalues()[0], 0.0);
  const double deviation = 1.0 / std::sqrt(weakest);
  if (!(deviation <= max_standard_deviation) ||
      weakest < kMinInformationPerMatch * total_weight) {
    result.is_degenerate = true;
    result.reason = Describe(eigen.eigenvectors().col(0), deviation);
    return result;
  }
  result.inverse = eigen.eigenvectors() *
                   eigen.eigenvalues().cwiseInverse().asDiagonal() *
                   eigen.eigenvectors().transpose();
  return result;
}

}  // namespace rgbd_pose
