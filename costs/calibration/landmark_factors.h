#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/landmark_data.h"
#include "costs/calibration/landmark_model.h"
#include "costs/calibration/landmark_sample.h"
#include "costs/calibration/lens.h"

// Factors that compare what landmark_model.h predicts with the pixels and
// inverse depths that the sensor measures. They estimate the camera with the
// poses and landmarks; LandmarkFactor (costs/factors/landmark.h) takes the
// camera as known and rejects a landmark behind the view. These do not, so that
// one wrong landmark does not end a calibration: give them a loss.

namespace rgbd_pose {

// The pixel (u, v) at which a view sees a landmark.
struct LandmarkPixelFactor {
  static constexpr char kName[] = "landmark_pixel";
  using Blocks =
      BlockList<PoseBlock, PoseBlock, InverseDepthBlock, CalibrationBlock>;
  static constexpr int kRows = 2;

  std::shared_ptr<const CalibrationModel> model;  // shared by a block's factors
  LandmarkData data;                              // of the view

  template <typename T>
  bool Residual(const PoseOf<T>& anchor, const PoseOf<T>& view,
                const Eigen::Matrix<T, 1, 1>& inverse_depth,
                const Eigen::Matrix<T, kCalibrationSize, 1>& y, T* r) const {
    const auto theta = model->origin.At(y);
    const CalibratedLens<T> lens(theta.data(), model->camera);
    const Eigen::Matrix<T, 3, 1> Y =
        InView(lens, anchor, view, inverse_depth[0], data);
    const Eigen::Matrix<T, 2, 1> pixel =
        lens.ToPixel(lens.Distort(Y[0] / Y[2], Y[1] / Y[2]));
    r[0] = (pixel[0] - data.u) * data.inverse_sigma_px;
    r[1] = (pixel[1] - data.v) * data.inverse_sigma_px;
    return true;
  }

  bool Jacobian(const PoseOf<double>& anchor, const PoseOf<double>& view,
                const Eigen::Matrix<double, 1, 1>& inverse_depth,
                const CalibrationVector& y, double* r,
                TangentJacobian<kRows, PoseBlock>* by_anchor,
                TangentJacobian<kRows, PoseBlock>* by_view,
                TangentJacobian<kRows, InverseDepthBlock>* by_inverse_depth,
                TangentJacobian<kRows, CalibrationBlock>* by_y) const {
    const CalibrationVector theta = model->origin.At(y);
    const CalibratedLens<double> lens(theta.data(), model->camera);
    const InViewDerivatives moved(lens, anchor, view, inverse_depth[0], data);
    const double z = 1.0 / moved.Y[2];
    const double a = moved.Y[0] * z, b = moved.Y[1] * z;
    const Eigen::Vector2d seen = lens.Distort(a, b);
    const Eigen::Vector2d pixel = lens.ToPixel(seen);
    const double w = data.inverse_sigma_px;
    r[0] = (pixel[0] - data.u) * w;
    r[1] = (pixel[1] - data.v) * w;
    Eigen::Matrix<double, 2, 3> project;
    project << z, 0.0, -a * z, 0.0, z, -b * z;
    const Eigen::Vector2d scale(w * theta[kFx], w * theta[kFy]);
    const Eigen::Matrix<double, 2, 3> by_point =
        scale.asDiagonal() * (DistortDerivative(lens, a, b) * project);
    *by_anchor = by_point * moved.by_anchor;
    *by_view = by_point * moved.by_view;
    *by_inverse_depth = by_point * moved.by_inverse_depth;
    by_y->setZero();
    by_y->leftCols<kLensSize>() = by_point * moved.by_lens;
    by_y->col(kColorReadout) = by_point * moved.by_color_readout;
    (*by_y)(0, kFx) += w * seen[0];
    (*by_y)(1, kFy) += w * seen[1];
    (*by_y)(0, kCx) += w;
    (*by_y)(1, kCy) += w;
    by_y->middleCols<kDistortionSize>(kK1) +=
        scale.asDiagonal() * DistortByCoefficients(lens, a, b);
    *by_y *= model->origin.width.asDiagonal();
    return true;
  }

  static LandmarkPixelFactor Sample(FactorSampler* random) {
    return {SampleModel(random), SampleLandmark(random)};
  }
  static std::vector<std::vector<double>> Near() {
    return {SampledAnchor(), SampledView(), SampledInverseDepth(), SampledY()};
  }
};

// The inverse depth measured in a view at the landmark.
struct LandmarkDepthFactor {
  static constexpr char kName[] = "landmark_depth";
  using Blocks =
      BlockList<PoseBlock, PoseBlock, InverseDepthBlock, CalibrationBlock>;
  static constexpr int kRows = 1;

  std::shared_ptr<const CalibrationModel> model;  // shared by a block's factors
  LandmarkData data;                              // of the view

  template <typename T>
  bool Residual(const PoseOf<T>& anchor, const PoseOf<T>& view,
                const Eigen::Matrix<T, 1, 1>& inverse_depth,
                const Eigen::Matrix<T, kCalibrationSize, 1>& y, T* r) const {
    const auto theta = model->origin.At(y);
    const CalibratedLens<T> lens(theta.data(), model->camera);
    const Eigen::Matrix<T, 3, 1> Y =
        InView(lens, anchor, view, inverse_depth[0], data);
    const T w = inverse_depth[0] / Y[2];
    r[0] = (MeasuredFrom(w, theta.data(), data) - data.depth.value) *
           data.depth.inverse_sigma;
    return true;
  }

  bool Jacobian(const PoseOf<double>& anchor, const PoseOf<double>& view,
                const Eigen::Matrix<double, 1, 1>& inverse_depth,
                const CalibrationVector& y, double* r,
                TangentJacobian<kRows, PoseBlock>* by_anchor,
                TangentJacobian<kRows, PoseBlock>* by_view,
                TangentJacobian<kRows, InverseDepthBlock>* by_inverse_depth,
                TangentJacobian<kRows, CalibrationBlock>* by_y) const {
    const CalibrationVector theta = model->origin.At(y);
    const CalibratedLens<double> lens(theta.data(), model->camera);
    const double d = inverse_depth[0];
    const InViewDerivatives moved(lens, anchor, view, d, data);
    const double z = 1.0 / moved.Y[2];
    const MeasuredFromDerivatives depth(d * z, theta.data(), data);
    const double weight = data.depth.inverse_sigma;
    const double by_w = weight * depth.by_w;
    const double by_z = -by_w * d * z * z;
    r[0] = weight * (depth.value - data.depth.value);
    *by_anchor = by_z * moved.by_anchor.row(2);
    *by_view = by_z * moved.by_view.row(2);
    (*by_inverse_depth)[0] = by_z * moved.by_inverse_depth[2] + by_w * z;
    *by_y = weight * depth.by_theta;
    by_y->leftCols<kLensSize>() += by_z * moved.by_lens.row(2);
    (*by_y)[kColorReadout] += by_z * moved.by_color_readout[2];
    *by_y *= model->origin.width.asDiagonal();
    return true;
  }

  static LandmarkDepthFactor Sample(FactorSampler* random) {
    return {SampleModel(random), SampleLandmark(random)};
  }
  static std::vector<std::vector<double>> Near() {
    return LandmarkPixelFactor::Near();
  }
};

// The inverse depth measured at the anchor.
struct AnchorDepthFactor {
  static constexpr char kName[] = "anchor_depth";
  using Blocks = BlockList<InverseDepthBlock, CalibrationBlock>;
  static constexpr int kRows = 1;

  std::shared_ptr<const CalibrationModel> model;  // shared by a block's factors
  LandmarkData data;                              // of the anchor

  template <typename T>
  bool Residual(const Eigen::Matrix<T, 1, 1>& inverse_depth,
                const Eigen::Matrix<T, kCalibrationSize, 1>& y, T* r) const {
    const auto theta = model->origin.At(y);
    r[0] = (MeasuredFrom(inverse_depth[0], theta.data(), data) -
            data.depth.value) *
           data.depth.inverse_sigma;
    return true;
  }

  bool Jacobian(const Eigen::Matrix<double, 1, 1>& inverse_depth,
                const CalibrationVector& y, double* r,
                TangentJacobian<kRows, InverseDepthBlock>* by_inverse_depth,
                TangentJacobian<kRows, CalibrationBlock>* by_y) const {
    const CalibrationVector theta = model->origin.At(y);
    const MeasuredFromDerivatives depth(inverse_depth[0], theta.data(), data);
    const double weight = data.depth.inverse_sigma;
    r[0] = weight * (depth.value - data.depth.value);
    (*by_inverse_depth)[0] = weight * depth.by_w;
    *by_y = weight * depth.by_theta * model->origin.width.asDiagonal();
    return true;
  }

  static AnchorDepthFactor Sample(FactorSampler* random) {
    return {SampleModel(random), SampleLandmark(random)};
  }
  static std::vector<std::vector<double>> Near() {
    return {SampledInverseDepth(), SampledY()};
  }
};

}  // namespace rgbd_pose
