#include "core/inertial/gravity_estimate.h"

#include <ceres/loss_function.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/util/format.h"
#include "core/util/quantile.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

constexpr double kGravity = 9.81;  // m/s^2

constexpr size_t kFewestMeans = 3;

// How far the acceleration measured may be from gravity: scales of
// accelerometers are wrong by up to 3 %, biases are 3 % of it.
constexpr double kGravityTolerance = 0.1;

// Means that scatter more do not measure one direction: 5 degrees.
constexpr double kMaxScatter = 0.0875 * kGravity;

// A bias so many times larger than kAccelBiasSigma is none: the mounting is
// wrong.
constexpr double kMaxBias = 5.0;

// Nothing is known better than this, m/s^2: 0.03 degrees. It is what the
// rotations of a path and the axes of a sensor leave.
constexpr double kLeastScatter = 0.005;

constexpr int kRounds = 20;

// Of Cauchy's loss, in sigmas: 95 % as efficient as least squares.
constexpr double kCauchyWidth = 2.385;

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Eigen::Vector3d MedianOf(const std::vector<MeanForce>& forces) {
  Eigen::Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const MeanForce& force : forces) {
      values.push_back((force.world_from_cam.rotation * force.up_in_cam)[axis]);
    }
    median[axis] = Median(values);
  }
  return median;
}

// The norms of what gravity and bias leave of each mean.
std::vector<double> ResidualsOf(const std::vector<MeanForce>& forces,
                                const Vector6d& x) {
  std::vector<double> norms;
  for (const MeanForce& force : forces) {
    norms.push_back((force.world_from_cam.rotation.conjugate() * x.head<3>() +
                     x.tail<3>() - force.up_in_cam)
                        .norm());
  }
  return norms;
}

// Six numbers are found from 3 n values, so that the residuals of few are too
// small.
double ScatterOf(const std::vector<double>& norms) {
  const double n = static_cast<double>(norms.size());
  return std::max(kLeastScatter, Median(norms) /
                                     std::sqrt(ChiSquaredMedian(3)) *
                                     std::sqrt(n / (n - 2.0)));
}

struct NormalEquations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
};

// Each mean has the weight of Cauchy's loss at its residual.
NormalEquations WeightedEquations(const std::vector<MeanForce>& forces,
                                  const std::vector<double>& norms,
                                  double scatter) {
  const ceres::CauchyLoss loss(kCauchyWidth);
  NormalEquations equations;
  equations.information.diagonal().tail<3>().setConstant(
      1.0 / (kAccelBiasSigma * kAccelBiasSigma));
  for (size_t i = 0; i < forces.size(); ++i) {
    double rho[3];
    const double sigmas = norms[i] / scatter;
    loss.Evaluate(sigmas * sigmas, rho);
    const double weight = rho[1] / (scatter * scatter);
    Eigen::Matrix<double, 3, 6> J;
    J << forces[i].world_from_cam.rotation.conjugate().toRotationMatrix(),
        Eigen::Matrix3d::Identity();
    equations.information += weight * J.transpose() * J;
    equations.right += weight * J.transpose() * forces[i].up_in_cam;
  }
  return equations;
}

// The standard deviation along the least certain axis across a direction.
double LargestSigmaAcross(const Eigen::Vector3d& direction,
                          const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d across =
      Eigen::Matrix3d::Identity() - direction * direction.transpose();
  const Eigen::Matrix3d covariance_across = across * covariance * across;
  return std::sqrt(
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance_across)
          .eigenvalues()[2]);
}

// Per axis of the world, in which gravity takes up what all means share.
double BiasEffect(const std::vector<MeanForce>& forces,
                  const Eigen::Matrix3d& bias_covariance) {
  const double n = static_cast<double>(forces.size());
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (const MeanForce& force : forces) {
    mean += force.world_from_cam.rotation.toRotationMatrix() / n;
  }
  double sum = 0.0;
  for (const MeanForce& force : forces) {
    const Eigen::Matrix3d turn =
        force.world_from_cam.rotation.toRotationMatrix() - mean;
    sum += (turn * bias_covariance * turn.transpose()).trace();
  }
  return std::sqrt(sum / (3.0 * n));
}

std::string FaultOf(const GravityEstimate& estimate) {
  if (std::abs(estimate.acceleration / kGravity - 1.0) > kGravityTolerance) {
    return Format(
        "what the accelerometer measures on average is %.2f m/s^2, not gravity",
        estimate.acceleration);
  }
  if (estimate.scatter > kMaxScatter) {
    return Format(
        "the directions that the accelerometer measures along the path scatter "
        "by %.1f degrees",
        kDegreesPerRadian * estimate.scatter / kGravity);
  }
  if (estimate.bias.norm() > kMaxBias * kAccelBiasSigma) {
    return Format(
        "the accelerometer does not fit how the camera turned (a bias of %.2f "
        "m/s^2): its mounting may be wrong",
        estimate.bias.norm());
  }
  return "";
}

}  // namespace

GravityEstimate EstimateGravity(const std::vector<MeanForce>& forces) {
  GravityEstimate estimate;
  estimate.means = static_cast<int>(forces.size());
  if (forces.size() < kFewestMeans) {
    estimate.refusal = Format(
        "%zu parts of the path, of a second each, have poses and inertial "
        "samples throughout; %zu are needed",
        forces.size(), kFewestMeans);
    return estimate;
  }
  const bool is_finite =
      std::all_of(forces.begin(), forces.end(), [](const MeanForce& force) {
        return force.world_from_cam.IsFinite() && force.up_in_cam.allFinite();
      });
  if (!is_finite) {
    estimate.refusal =
        "a pose of the path, a sample or the mounting of the sensor is not "
        "finite";
    return estimate;
  }
  Vector6d x;  // [s b]
  x << MedianOf(forces), Eigen::Vector3d::Zero();
  NormalEquations equations;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> norms = ResidualsOf(forces, x);
    estimate.scatter = ScatterOf(norms);
    equations = WeightedEquations(forces, norms, estimate.scatter);
    x = equations.information.ldlt().solve(equations.right);
  }
  const Matrix6d covariance = equations.information.inverse();
  estimate.acceleration = x.head<3>().norm();
  estimate.bias = x.tail<3>();
  estimate.bias_covariance = covariance.bottomRightCorner<3, 3>();
  estimate.bias_effect = BiasEffect(forces, estimate.bias_covariance);
  estimate.refusal = FaultOf(estimate);
  if (!estimate.ok()) return estimate;
  estimate.up = x.head<3>().normalized();
  estimate.sigma =
      LargestSigmaAcross(estimate.up, covariance.topLeftCorner<3, 3>()) /
      estimate.acceleration;
  return estimate;
}

GravityEstimate EstimateGravity(const ForceMeter& meter,
                                const std::map<int, Trajectory>& paths) {
  GravityEstimate estimate;
  if (!meter.sensor().calibration.cam_from_imu.has_value()) {
    estimate.refusal =
        "the axes of the inertial sensor in those of the camera are not known "
        "(T_cam_imu)";
  } else if (meter.samples().empty()) {
    estimate.refusal = "there are no inertial samples";
  } else {
    Trajectory longest;
    int segment = 0;
    for (const auto& [number, path] : paths) {
      if (path.size() <= longest.size()) continue;
      longest = path;
      segment = number;
    }
    estimate = EstimateGravity(meter.Along(longest));
    estimate.segment = segment;
  }
  return estimate;
}

}  // namespace rgbd_pose
