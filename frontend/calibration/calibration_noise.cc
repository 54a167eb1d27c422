#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/factors/blocks.h"
#include "core/util/quantile.h"
#include "costs/calibration/landmark_factors.h"
#include "frontend/calibration/calibration_result.h"

namespace rgbd_pose {
namespace {

// The error of a depth measurement at a landmark.
struct Sample {
  double depth = 0.0;  // expected depth, m
  double pixel = 0.0;  // error of a single pixel, m
  double mean = 0.0;   // error of the looked-up depth, m
  double share = 0.0;  // share of the landmark position from this depth
};

// Appends the depths of the i-th landmark in its anchor and in all views.
void CollectDepths(const CalibrationViews& views, const CalibrationState& state,
                   const std::vector<PoseOf<double>>& poses, size_t i,
                   std::vector<Sample>* samples) {
  const Landmark& landmark = views.landmarks[i];
  const PoseOf<double>& anchor = poses[landmark.anchor];
  const Eigen::Matrix<double, 1, 1> d(state.inverse_depths[i]);
  const CalibrationVector& theta = state.theta;
  const auto model = ModelOf(views);
  const CalibratedLens<double> lens(theta.data(), views.camera);
  const size_t first = samples->size();
  double information = 0.0;
  const auto add = [&](const LandmarkData& data, double w,
                       const Eigen::Vector3d& ray, double by_depth) {
    const MeasuredInverseDepth& depth = data.depth;
    information += by_depth;
    if (depth.pixel_value == 0.0) return;
    const double expected = MeasuredFrom(w, theta.data(), data);
    // The depth is moved along the plane to the position of the landmark.
    const double there = depth.plane.dot(ray);
    const double pixel =
        depth.pixel_value * there / depth.plane.dot(depth.pixel_ray);
    const double z2 = 1.0 / (expected * expected);
    const Sample sample = {1.0 / expected, (pixel - expected) * z2,
                           (depth.value * there - expected) * z2, by_depth};
    if (sample.depth > 0.0 && std::isfinite(sample.pixel) &&
        std::isfinite(sample.mean)) {
      samples->push_back(sample);
    }
  };
  double r[2];
  Eigen::Matrix<double, 1, 1> by_depth;
  TangentJacobian<1, PoseBlock> by_anchor, by_view;
  TangentJacobian<1, CalibrationBlock> by_theta;
  const LandmarkData own = DataOf(views, landmark, state);
  AnchorDepthFactor{model, own}.Jacobian(d, theta, r, &by_depth, &by_theta);
  add(own, d[0], landmark.depth.ray, by_depth.squaredNorm());
  for (int k = 0; k < landmark.num_views; ++k) {
    const LandmarkView& view = views.views[landmark.first_view + k];
    const LandmarkData data = DataOf(views, landmark, view, state);
    const PoseOf<double>& there = poses[view.keyframe];
    Eigen::Vector2d by_depth_px;
    TangentJacobian<2, PoseBlock> by_anchor_px, by_view_px;
    TangentJacobian<2, CalibrationBlock> by_theta_px;
    LandmarkPixelFactor{model, data}.Jacobian(anchor, there, d, theta, r,
                                              &by_anchor_px, &by_view_px,
                                              &by_depth_px, &by_theta_px);
    information += by_depth_px.squaredNorm();
    if (view.depth.inverse_sigma == 0.0) continue;
    // Offset from the position of the feature to that of the landmark.
    const Eigen::Vector3d beside(r[0] / data.inverse_sigma_px / theta[kFx],
                                 r[1] / data.inverse_sigma_px / theta[kFy],
                                 0.0);
    LandmarkDepthFactor{model, data}.Jacobian(
        anchor, there, d, theta, r, &by_anchor, &by_view, &by_depth, &by_theta);
    const Eigen::Vector3d Y = InView(lens, anchor, there, d[0], data);
    add(data, d[0] / Y.z(), view.depth.ray + beside, by_depth.squaredNorm());
  }
  for (size_t s = first; s < samples->size(); ++s) {
    (*samples)[s].share /= information;
  }
}

// The variance of a mean of 3 x 3 pixels, divided by the variance of one pixel.
// A depth that contributes a share h to the position of a landmark leaves
// residuals with these variances (mean m, pixel p):
//   (1 - h) m   and   p - h m.
double VarianceShare(const std::vector<Sample>& samples) {
  double share = 0.0;
  for (int round = 0; round < 3; ++round) {
    std::vector<double> ratios[2];
    for (const Sample& sample : samples) {
      const double z2 = sample.depth * sample.depth;
      ratios[0].push_back(std::abs(sample.mean) / z2 /
                          std::sqrt(std::max(1e-3, 1.0 - sample.share)));
      ratios[1].push_back(std::abs(sample.pixel) / z2 /
                          std::sqrt(1.0 - sample.share * share));
    }
    const double ratio = Median(ratios[0]) / Median(ratios[1]);
    share = std::min(0.99, ratio * ratio);
  }
  return share;
}

// Weighted least-squares fit of sigma = a + b z^2. A coefficient that is not
// significant (2 standard deviations) is set to 0.
void FitSigmas(double relative_error, DepthNoiseFit* fit) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const DepthScatter& bin : fit->scatter) {
    const Eigen::Vector2d row(1.0, bin.depth * bin.depth);
    const double weight =
        1.0 / (relative_error * relative_error * bin.sigma * bin.sigma);
    information += weight * row * row.transpose();
    right += weight * bin.sigma * row;
  }
  const Eigen::Matrix2d covariance = information.inverse();
  const Eigen::Vector2d both = covariance * right;
  const Eigen::Vector2d sigmas = covariance.diagonal().cwiseSqrt();
  constexpr double kMinSignificance = 2.0;
  const bool has_constant = both[0] > kMinSignificance * sigmas[0];
  const bool has_quadratic = both[1] > kMinSignificance * sigmas[1];
  if (has_constant && has_quadratic) {
    fit->model.constant = both[0];
    fit->model.quadratic = both[1];
    fit->constant_sigma = sigmas[0];
    fit->quadratic_sigma = sigmas[1];
  } else if (has_constant) {
    fit->model.constant = right[0] / information(0, 0);
    fit->constant_sigma = 1.0 / std::sqrt(information(0, 0));
  } else {
    fit->model.quadratic = right[1] / information(1, 1);
    fit->quadratic_sigma = 1.0 / std::sqrt(information(1, 1));
  }
}

}  // namespace

std::optional<DepthNoiseFit> FitDepthNoise(const CalibrationViews& views,
                                           const CalibrationState& state,
                                           const DepthNoiseModel& old) {
  const std::vector<PoseOf<double>> poses = PosesOf(state);
  std::vector<Sample> samples;
  for (size_t i = 0; i < views.landmarks.size(); ++i) {
    CollectDepths(views, state, poses, i, &samples);
  }
  constexpr size_t kMinSamples = 300;
  if (samples.size() < kMinSamples) return std::nullopt;

  const double share = VarianceShare(samples);
  DepthNoiseFit fit;
  fit.samples = static_cast<int>(samples.size());
  fit.model.mean_share = std::sqrt(share);
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.depth < b.depth; });
  std::vector<double> in_old_sigmas;
  constexpr size_t kMostBins = 24, kMinInBin = 100;
  const size_t bins = std::min(kMostBins, samples.size() / kMinInBin);
  for (size_t bin = 0; bin < bins; ++bin) {
    const size_t begin = bin * samples.size() / bins;
    const size_t end = (bin + 1) * samples.size() / bins;
    std::vector<double> errors;
    double squares = 0.0;
    for (size_t s = begin; s < end; ++s) {
      const Sample& sample = samples[s];
      errors.push_back(std::abs(sample.pixel) /
                       std::sqrt(1.0 - sample.share * share));
      in_old_sigmas.push_back(errors.back() / old.sigma(sample.depth));
      squares += sample.depth * sample.depth;
    }
    constexpr double kLeast = 1e-6;  // m
    fit.scatter.push_back({std::sqrt(squares / errors.size()),
                           std::max(kLeast, kSigmaOfMedian * Median(errors))});
  }
  fit.in_old_sigmas = kSigmaOfMedian * Median(in_old_sigmas);
  // The relative error of a median of absolute values is 1.17 / sqrt(n).
  const double in_bin = static_cast<double>(samples.size()) / bins;
  FitSigmas(1.17 / std::sqrt(in_bin), &fit);
  return fit;
}

}  // namespace rgbd_pose
