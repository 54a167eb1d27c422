#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "costs/calibration/bundle_adjustment.h"

namespace rgbd_pose {

// The result for one parameter.
struct CalibratedParameter {
  // What the recording says about the parameter.
  enum class Status {
    kFixed,         // not asked for, or not observable
    kUndetermined,  // keeps its value: not determined, or no better fit
    kDetermined,
  };
  Status status = Status::kFixed;  // of this parameter
  double before = 0.0;             // value of the first camera
  double prior = 0.0;              // standard deviation of the prior
  double found = 0.0;              // the recording's estimate
  double sigma = 0.0;              // standard deviation of the estimate
};

// The residual of a held-out view, px. Used for plots.
struct HeldOutResidual {
  double u = 0.0;          // column in the image
  double v = 0.0;          // row in the image
  Eigen::Vector2d before;  // with the first camera: predicted - seen
  Eigen::Vector2d after;   // with the camera found
  Eigen::Vector2d flow;    // motion in the image, px/s
};

// One parameter from both halves of a recording, each calibrated separately.
struct HalvesOfParameter {
  int part = 0;         // index, see CalibrationIndex
  double first = 0.0;   // estimate from the first half
  double second = 0.0;  // estimate from the second half
  double sigma = 0.0;   // standard deviation of their difference

  // The difference of the halves in standard deviations.
  double Sigmas() const { return std::abs(second - first) / sigma; }
};

// The scatter of depths in one depth bin.
struct DepthScatter {
  double depth = 0.0;  // m
  double sigma = 0.0;  // m, for single pixels
};

// The depth noise that was estimated from a recording.
struct DepthNoiseFit {
  DepthNoiseModel model;         // sigma(z) = constant + quadratic z^2
  double constant_sigma = 0.0;   // standard deviation of the coefficient; 0:
  double quadratic_sigma = 0.0;  // taken as 0 since the two are not separable
  std::vector<DepthScatter> scatter;  // the fitted data
  int samples = 0;                    // number of depths

  // The scatter of depths in units of the previous model's sigmas.
  double in_old_sigmas = 0.0;

  // Whether it is noise; a larger scatter means that depth is displaced.
  bool IsPlausible() const { return in_old_sigmas <= 5.0; }
};

// The result of a calibration.
struct CalibrationResult {
  // In the order of kCalibrationParameters, relative to the recording as the
  // first camera corrects it.
  std::array<CalibratedParameter, kCalibrationSize> parameters;

  // Whether the camera found is better than the first one. It is accepted if
  // the halves of the recording confirm it. If not, `camera` is the first one:
  // see `reason`.
  bool is_better = false;
  bool is_accepted = false;
  std::string reason;
  RgbdCamera camera;

  // The recording's estimate of the camera, accepted or not.
  RgbdCamera found;

  // The data that the calibration used.
  int keyframes = 0;       // of the largest segment
  int pairs = 0;           // of the keyframes
  int held_out_pairs = 0;  // of the pairs
  int landmarks = 0;
  int views = 0;  // of the landmarks

  // Mean robust cost of a held-out view.
  double cost_before = 0.0;  // with the first camera
  double cost_after = 0.0;   // with the camera found
  double gain_sigmas = 0.0;  // their difference in standard deviations
  double cost_of_map = 0.0;  // with the first camera and the poses of the map

  // Mean robust cost of a view in one half of the recording, with the first
  // camera and with the camera found in the other half, and their difference in
  // standard errors over ten parts of the recording. 0 if not compared.
  double unseen_before = 0.0;
  double unseen_after = 0.0;
  double unseen_sigmas = 0.0;

  // Spread of the residuals, in px and in sigmas of the depth noise.
  double pixel_before = 0.0;  // with the first camera
  double pixel_after = 0.0;   // with the camera found
  double depth_before = 0.0;  // with the first camera
  double depth_after = 0.0;   // with the camera found
  std::vector<HeldOutResidual> residuals;

  // Depth noise with the resulting camera; empty if there are too few depths.
  std::optional<DepthNoiseFit> noise;
  std::optional<DepthNoiseFit> noise_before;  // with the first camera
  std::optional<DepthNoiseFit> noise_found;   // with the camera found

  // The parameters that are determined.
  FreeParts Determined() const {
    FreeParts determined;
    for (int k = 0; k < kCalibrationSize; ++k) {
      determined[k] =
          parameters[k].status == CalibratedParameter::Status::kDetermined;
    }
    return determined;
  }

  // Takes the noise, if it is plausible, into the camera.
  void UseNoise() {
    if (noise.has_value() && noise->IsPlausible()) {
      camera.depth_noise = noise->model;
    }
  }

  // Accepts the camera found, with its noise, unless there is a reason not to.
  // Then `camera` is `first`.
  void Conclude(const RgbdCamera& first, const std::string& why_not) {
    reason = why_not;
    is_accepted = why_not.empty();
    camera = is_accepted ? found : first;
    noise = is_accepted ? noise_found : noise_before;
    if (is_accepted) UseNoise();
  }

  // Error of the motions of pairs against the ground truth (RMSE, m), with the
  // poses estimated for each camera; 0 without ground truth.
  double truth_before = 0.0;  // with the first camera
  double truth_after = 0.0;   // with the camera found

  // The halves' estimates of the parameters that this and earlier passes
  // determined; empty if a half does not determine them.
  std::vector<HalvesOfParameter> halves;

  // Factor on error bars, if the halves differ by more than residuals explain.
  double halves_spread = 1.0;

  // How far depth, or the first row of colour, turned out to be displaced, px
  // (median over landmarks). If it is large, the recording should be mapped
  // again with the camera found.
  double displacement_px = 0.0;
  int passes = 1;

  // The source of the depth scale in words; empty if there is none.
  std::string scale_from;
};

// The difference of the halves as a root mean square in standard deviations:
// about 1 if the error bars are right, 0 if the halves were not compared.
double SpreadOfHalves(const std::vector<HalvesOfParameter>& halves);

// Calibrates each half of a recording (in time) separately, starting from the
// result for the whole one. A real error of the camera shows in both halves.
// Empty if a half cannot determine the parameters. `on_iteration`: see
// BundleAdjustment.
std::vector<HalvesOfParameter> SplitHalfConsistency(
    const CalibrationViews& views, const CalibrationState& found,
    const FreeParts& is_free, const CalibrationPrior& prior,
    const std::function<void()>& on_iteration = {});

// Fits the noise of single depth pixels robustly to the scatter of depths at
// landmarks; errors of feature positions do not matter. `old` is the previous
// noise model. Returns nothing if there are too few depths.
std::optional<DepthNoiseFit> FitDepthNoise(const CalibrationViews& views,
                                           const CalibrationState& state,
                                           const DepthNoiseModel& old);

}  // namespace rgbd_pose
