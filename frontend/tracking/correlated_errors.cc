#include "frontend/tracking/correlated_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace rgbd_pose {
namespace {

constexpr int kColumns = 4;
constexpr int kRows = 3;

// Independent errors scatter in cells as in single matches, up to this factor
// by chance.
constexpr double kMaxByChance = 1.5;

// The scatter of single matches whose errors are as large as the noise model
// says: small, as large residuals have small weights.
constexpr double kIndependent = 0.2;

int CellOf(double at, int size, int cells) {
  return std::clamp(static_cast<int>(at * cells / size), 0, cells - 1);
}

}  // namespace

double CovarianceInflation(const Correspondences& matches,
                           const MotionEstimate& estimate) {
  const Camera& camera = matches.camera();
  // Errors that the noise model does not cover are no smaller here.
  const double spread = std::max(1.0, estimate.sigma);
  // Derivatives are by a rotation, then a translation, in current axes.
  MotionMatrix hessian = 1e-3 * MotionMatrix::Identity();  // solvable
  MotionMatrix single = MotionMatrix::Zero();
  std::array<MotionVector, kColumns * kRows> gradients;
  gradients.fill(MotionVector::Zero());
  for (size_t i = 0; i < matches.size(); ++i) {
    const auto& [ref, cur] = matches[i];
    if (!(estimate.weights[i] > 0.0 && ref.depth > 0.0)) continue;
    const Eigen::Vector3d point = estimate.cur_from_prev * matches.Point(ref);
    if (!(point.z() > 0.0)) continue;
    const double inverse = 1.0 / point.z();
    const double x = point.x() * inverse, y = point.y() * inverse;
    MotionVector by_u, by_v;
    by_u << -x * y, 1.0 + x * x, -y, inverse, 0.0, -x * inverse;
    by_v << -1.0 - y * y, x * y, x, 0.0, inverse, -y * inverse;
    by_u *= camera.fx;
    by_v *= camera.fy;
    const double u = camera.fx * x + camera.cx - cur.u;
    const double v = camera.fy * y + camera.cy - cur.v;
    const double sigma = spread * std::hypot(ref.sigma_px, cur.sigma_px);
    const double weight = estimate.weights[i] / (sigma * sigma);
    hessian += weight * (by_u * by_u.transpose() + by_v * by_v.transpose());
    const MotionVector gradient = weight * (u * by_u + v * by_v);
    single += gradient * gradient.transpose();
    gradients[CellOf(cur.v, camera.height, kRows) * kColumns +
              CellOf(cur.u, camera.width, kColumns)] += gradient;
  }
  MotionMatrix excess = -kMaxByChance * single;
  for (const MotionVector& gradient : gradients) {
    excess += gradient * gradient.transpose();
  }
  const double correlated = hessian.llt().solve(excess).trace() / 6.0;
  return 1.0 + std::max(0.0, correlated) / kIndependent;
}

}  // namespace rgbd_pose
