#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/distance.h"
#include "core/factors/sampler.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/landmark_sample.h"

namespace rgbd_pose {

// A DistanceFactor between two points whose positions in the axes of their
// bodies are measured by the depth camera: the depth factor scales them.
struct ScaledDistanceFactor {
  static constexpr char kName[] = "scaled_distance";
  using Blocks = BlockList<PoseBlock, PoseBlock, CalibrationBlock>;
  static constexpr int kRows = 1;
  using ByPose = TangentJacobian<kRows, PoseBlock>;

  std::shared_ptr<const CalibrationModel> model;  // shared by a block's factors
  DistanceFactor distance;  // with the positions as measured

  template <typename T>
  bool Residual(const PoseOf<T>& a, const PoseOf<T>& b,
                const Eigen::Matrix<T, kCalibrationSize, 1>& y, T* r) const {
    using std::sqrt;
    const T factor = model->origin.At(y)[kDepthFactor];
    const auto in_world = [&](const PoseOf<T>& pose, const Eigen::Vector3d& X) {
      const Eigen::Matrix<T, 3, 1> scaled = factor * X.cast<T>();
      return Eigen::Matrix<T, 3, 1>(pose.p + pose.q * scaled);
    };
    const Eigen::Matrix<T, 3, 1> apart =
        in_world(a, distance.in_a) - in_world(b, distance.in_b);
    // The root has no derivative at 0. NaN stays, so that a solver notices it.
    const T squared = apart.squaredNorm();
    const T length = squared == T(0.0) ? T(0.0) : sqrt(squared);
    r[0] = (length - T(distance.metres)) / T(distance.sigma);
    return true;
  }

  bool Jacobian(const PoseOf<double>& a, const PoseOf<double>& b,
                const CalibrationVector& y, double* r, ByPose* by_a,
                ByPose* by_b,
                TangentJacobian<kRows, CalibrationBlock>* by_y) const {
    const double factor = model->origin.At(y)[kDepthFactor];
    DistanceFactor scaled = distance;
    scaled.in_a *= factor;
    scaled.in_b *= factor;
    scaled.Jacobian(a, b, r, by_a, by_b);
    const double by_factor = by_a->rightCols<3>().dot(a.q * distance.in_a) +
                             by_b->rightCols<3>().dot(b.q * distance.in_b);
    by_y->setZero();
    (*by_y)[kDepthFactor] = model->origin.width[kDepthFactor] * by_factor;
    return true;
  }

  static ScaledDistanceFactor Sample(FactorSampler* random) {
    return {SampleModel(random), DistanceFactor::Sample(random)};
  }
  static std::vector<std::vector<double>> Near() {
    return {SampledAnchor(), SampledView(), SampledY()};
  }
};

}  // namespace rgbd_pose
