#include "core/estimation/degeneracy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/util/format.h"
#include "core/util/small_matrix.h"

namespace rgbd_pose {
namespace {

// The information on a rotation must exceed the spurious one by this factor.
constexpr double kSpuriousMargin = 3.0;

// A Hessian scaled to a diagonal of ones is singular below this eigenvalue.
constexpr double kSingular = 1e-12;

constexpr std::array<const char*, 6> kDirections = {
    "rotation about x",    "rotation about y",    "rotation about z",
    "translation along x", "translation along y", "translation along z"};

// Units that make rotations and translations comparable. They are averaged over
// the axes: gliding along a slightly tilted wall also changes the distance to
// it, by little, but by many of its own standard deviations.
MotionVector MeanUnits(const MotionMatrix& hessian) {
  MotionVector units;
  for (const int first : {0, 3}) {
    const double mean = hessian.diagonal().segment<3>(first).mean();
    units.segment<3>(first).setConstant(mean > 0.0 ? 1.0 / std::sqrt(mean)
                                                   : 1.0);
  }
  return units;
}

// The dominant directions, the strongest first, and why they are not known: a
// standard deviation, or less information than noise alone seems to give.
std::string Describe(const MotionVector& direction, double deviation,
                     bool may_be_noise) {
  std::array<int, 6> order = {0, 1, 2, 3, 4, 5};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::abs(direction[a]) > std::abs(direction[b]);
  });
  std::string text = kDirections[order[0]];
  for (int i = 1; i < 6; ++i) {
    if (std::abs(direction[order[i]]) > 0.4 * direction.norm()) {
      text += std::string(" with ") + kDirections[order[i]];
    }
  }
  text += " is not determined";
  if (std::isinf(deviation)) return text + " at all";
  const char* const unit = order[0] < 3 ? "rad" : "m";
  if (may_be_noise) {
    return text + Format(
                      ": noise alone may give the %.2g %s to which it seems "
                      "known, as where points are on a line or far away",
                      deviation, unit);
  }
  return text + Format(" (standard deviation %.2g %s)", deviation, unit);
}

// The largest standard deviation within three rows, and the change of all six.
struct WeakDirection {
  double deviation;
  MotionVector direction;
};

WeakDirection WeakestOf(const MotionMatrix& covariance, int first) {
  const auto eigen = EigenOf(covariance.block<3, 3>(first, first));
  return {std::sqrt(eigen.eigenvalues()[2]),
          covariance.middleCols<3>(first) * eigen.eigenvectors().col(2)};
}

// The information of a match on a small change of the motion of its camera:
// points turn by `turn` and move by -`shift`, along the current axes.
double InformationOn(const Match& match, const Eigen::Vector3d& point,
                     double fx, const Eigen::Vector3d& turn,
                     const Eigen::Vector3d& shift) {
  const auto& [prev, cur] = match;
  const Eigen::Vector3d moved = turn.cross(point) - shift;
  const double z = point.z();
  const Eigen::Vector2d across =
      moved.head<2>() - moved.z() / z * point.head<2>();
  const double px = std::hypot(prev.sigma_px, cur.sigma_px) * z / fx;
  double known = across.squaredNorm() / (px * px);
  if (prev.depth > 0.0 && cur.depth > 0.0) {
    known += std::pow(moved.z(), 2) /
             (std::pow(prev.sigma_depth, 2) + std::pow(cur.sigma_depth, 2));
  }
  return known;
}

// The share of the matches' information on a change of the motion that comes
// from inliers, without the three that contribute most.
double SupportedShare(const std::vector<CameraMatches>& cameras,
                      const MotionEstimate& estimate,
                      const MotionVector& change) {
  double total = 0.0, agreeing = 0.0;
  std::array<double, 3> most = {};  // the largest first
  for (const auto& [matches, first, body_from_cam] : cameras) {
    const Rigid3d motion = CameraMotion(body_from_cam, estimate.cur_from_prev);
    const MotionVector of_camera =
        CameraMotionJacobian(body_from_cam, estimate.cur_from_prev) * change;
    const Eigen::Vector3d turn = of_camera.head<3>();
    const Eigen::Vector3d shift = motion.rotation * of_camera.tail<3>();
    for (size_t i = 0; i < matches->size(); ++i) {
      const auto& [prev, cur] = (*matches)[i];
      const double weight = estimate.weights[first + i];
      if (weight == 0.0 || !(prev.depth + cur.depth > 0.0)) continue;
      const Eigen::Vector3d point =
          cur.depth > 0.0 ? matches->Point(cur) : motion * matches->Point(prev);
      double known = weight * InformationOn((*matches)[i], point,
                                            matches->camera().fx, turn, shift);
      total += known;
      if (!estimate.is_inlier[first + i]) continue;
      agreeing += known;
      for (double& value : most) {
        if (known > value) std::swap(known, value);
      }
    }
  }
  const double supported = agreeing - most[0] - most[1] - most[2];
  return total > 0.0 ? std::max(supported, 0.0) / total : 1.0;
}

}  // namespace

Degeneracy FindDegeneracy(const MotionMatrix& hessian,
                          double spurious_information,
                          double max_standard_deviation) {
  Degeneracy result;
  if (!hessian.allFinite()) {
    result.reason = "the Hessian is not finite";
    return result;
  }
  if (hessian.isZero()) {
    result.reason =
        "no match has any weight: is the guess far off, are sigmas too small, "
        "or are all points nearer than 0.1 m?";
    return result;
  }
  const MotionVector means = MeanUnits(hessian);
  // Scaled by what each parameter would be known to if it were the only one.
  MotionVector unit = hessian.diagonal();
  for (double& value : unit) value = value > 0.0 ? 1.0 / std::sqrt(value) : 1.0;
  const auto eigen = EigenOf(unit.asDiagonal() * hessian * unit.asDiagonal());
  if (!(eigen.eigenvalues()[0] > kSingular)) {
    result.reason = Describe(
        unit.cwiseProduct(eigen.eigenvectors().col(0)).cwiseQuotient(means),
        INFINITY, /*may_be_noise=*/false);
    return result;
  }
  const MotionMatrix covariance =
      unit.asDiagonal() * eigen.eigenvectors() *
      eigen.eigenvalues().cwiseInverse().asDiagonal() *
      eigen.eigenvectors().transpose() * unit.asDiagonal();
  const WeakDirection rotation = WeakestOf(covariance, 0);
  const WeakDirection translation = WeakestOf(covariance, 3);
  const double known = 1.0 / (rotation.deviation * rotation.deviation);
  const bool is_rotation = rotation.deviation > max_standard_deviation ||
                           known < kSpuriousMargin * spurious_information;
  if (is_rotation || translation.deviation > max_standard_deviation) {
    const WeakDirection& weak = is_rotation ? rotation : translation;
    result.reason =
        Describe(weak.direction.cwiseQuotient(means), weak.deviation,
                 weak.deviation <= max_standard_deviation);
    return result;
  }
  result.inverse = covariance;
  result.weakest_rotation = known * rotation.direction;
  result.known_rotation = known;
  return result;
}

void JudgeWeakestRotation(const std::vector<CameraMatches>& cameras,
                          const MotionEstimate& estimate, double by_pixels,
                          double spurious_information,
                          double max_standard_deviation, Degeneracy* result) {
  const double share =
      SupportedShare(cameras, estimate, result->weakest_rotation);
  const double known =
      by_pixels + share * std::max(result->known_rotation - by_pixels, 0.0);
  const double least = 1.0 / (max_standard_deviation * max_standard_deviation);
  if (known >= std::max(least, kSpuriousMargin * spurious_information)) return;
  MotionVector rotation = result->weakest_rotation;
  rotation.tail<3>().setZero();  // in another unit
  const double deviation = 1.0 / std::sqrt(known);
  result->reason =
      Describe(rotation, deviation, deviation <= max_standard_deviation);
}

double SpuriousInformation(const std::vector<CameraMatches>& cameras,
                           const std::vector<double>& weights) {
  double sum = 0.0;
  for (const auto& [matches, first, body_from_cam] : cameras) {
    const double focal = matches->camera().fx;
    for (size_t i = 0; i < matches->size(); ++i) {
      const auto& [prev, cur] = (*matches)[i];
      const Observation& o = prev.depth > 0.0 ? prev : cur;
      double spurious = 1.0;  // without a depth there are only directions
      if (o.depth > 0.0) {
        const double along = o.sigma_depth * focal;
        const double across = o.depth * o.sigma_px;
        const double a = along * along, b = across * across;
        spurious = (a * a + b * b) / (2.0 * a * b);
      }
      sum += weights.empty() ? spurious : weights[first + i] * spurious;
    }
  }
  return sum;
}

}  // namespace rgbd_pose
