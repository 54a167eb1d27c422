#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "costs/calibration/bundle_adjustment.h"

namespace rgbd_pose {

// What became of one parameter.
struct CalibratedParameter {
  // What the recording says of it.
  enum class Status {
    kFixed,         // was not asked for, or nothing could tell it
    kUndetermined,  // that stays: it does not tell, or fits no better so
    kDetermined,
  };
  Status status = Status::kFixed;  // what the recording says of it
  double before = 0.0;             // of the first camera
  double prior = 0.0;              // its standard deviation
  double found = 0.0;              // where the recording would have it
  double sigma = 0.0;              // the standard deviation of that
};

// What is left of a held-out view, px: for pictures.
struct HeldOutResidual {
  double u = 0.0;          // where
  double v = 0.0;          // likewise
  Eigen::Vector2d before;  // with the first camera
  Eigen::Vector2d after;   // with the camera found
};

// What the first half of a recording and the second one say of the same
// parameter, each by itself.
struct HalvesOfParameter {
  int part = 0;         // which, see CalibrationIndex
  double first = 0.0;   // of the first half
  double second = 0.0;  // of the second one
  double sigma = 0.0;   // of their difference

  // How far apart they are, in standard deviations.
  double Sigmas() const;
};

// How much depths of about one size scatter.
struct DepthScatter {
  double depth = 0.0;  // m
  double sigma = 0.0;  // m, of single pixels
};

// What a recording says of the noise of its depths.
struct DepthNoiseFit {
  DepthNoiseModel model;         // sigma(z) = constant + quadratic z^2
  double constant_sigma = 0.0;   // their standard deviations; 0: taken as 0
  double quadratic_sigma = 0.0;  // since it is not separable from that
  std::vector<DepthScatter> scatter;  // what it was fitted to
  int samples = 0;                    // depths

  // How much depths scatter, in the sigmas of the model that was there.
  double in_old_sigmas = 0.0;
};

// What came of a calibration.
struct CalibrationResult {
  // In the order of kCalibrationParameters, about the recording as the first
  // camera has it corrected.
  std::array<CalibratedParameter, kCalibrationSize> parameters;

  // Whether `camera` is to be taken; else it is the first one, and `reason`
  // says in words why.
  bool is_accepted = false;
  std::string reason;
  RgbdCamera camera;

  // Where the recording would have the camera, better or not.
  RgbdCamera found;

  // Of what it was made.
  int keyframes = 0;       // of the largest segment
  int pairs = 0;           // of them
  int held_out_pairs = 0;  // of these
  int landmarks = 0;       // points
  int views = 0;           // of the points

  // Mean robust cost of a held-out view with the first camera and the one that
  // was found, and their difference in its standard deviations.
  double cost_before = 0.0;  // with the first camera
  double cost_after = 0.0;   // with the camera found
  double gain_sigmas = 0.0;  // their difference
  double cost_of_map = 0.0;  // with the first camera, poses as they were mapped

  // Spread of residuals with either: px, and in sigmas of the depth noise.
  double pixel_before = 0.0;  // with the first camera
  double pixel_after = 0.0;   // with the camera found
  double depth_before = 0.0;  // with the first camera
  double depth_after = 0.0;   // with the camera found
  std::vector<HeldOutResidual> residuals;

  // How noisy depth is, with the camera to go on with; none: too few depths.
  std::optional<DepthNoiseFit> noise;

  // How far the motions of pairs are from the ground truth (RMSE, m), from the
  // poses that go with either camera; 0: there is none.
  double truth_before = 0.0;  // with the first camera
  double truth_after = 0.0;   // with the camera found

  // What the halves of the recording say of what is determined; may be empty.
  std::vector<HalvesOfParameter> halves;

  // So many times wider than residuals say error bars are, as halves were so
  // far apart.
  double halves_spread = 1.0;

  // How far depth, or the first row of colour, turned out to be displaced, px
  // (the median of views). If that is much, it is due to be mapped again with
  // the camera found.
  double displacement_px = 0.0;
  int passes = 1;

  // What gave depth its scale, in words; empty: nothing did.
  std::string scale_from;
};

// How far halves are apart in all, as a root mean square in standard
// deviations: about 1 if error bars are right; 0: they were not compared.
double SpreadOfHalves(const std::vector<HalvesOfParameter>& halves);

// Calibrates both halves of a recording (in time) by themselves, from where all
// of it ended. What is wrong with a camera is wrong in both; what is absorbed
// of something else depends on what is seen. Empty if a half has too few views
// or does not tell.
std::vector<HalvesOfParameter> SplitHalfConsistency(
    const CalibrationViews& views, const CalibrationState& found,
    const std::array<bool, kCalibrationSize>& is_free,
    const CalibrationPrior& prior);

// Fits the noise of single pixels' depths to how they scatter about landmarks
// that are seen in several keyframes, robustly. Errors of where a feature is
// seen do not count: depths are compared where the landmark is. `old`: the
// model that was there. Nothing if there are too few.
std::optional<DepthNoiseFit> FitDepthNoise(const CalibrationViews& views,
                                           const CalibrationState& state,
                                           const DepthNoiseModel& old);

}  // namespace rgbd_pose
