#include "frontend/calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/input_error.h"
#include "costs/calibration/bundle_adjustment.h"
#include "frontend/calibration/calibration_comparison.h"
#include "frontend/calibration/calibration_verdict.h"

namespace rgbd_pose {
namespace {

using Status = CalibratedParameter::Status;

// The members of Camera in the order of CalibrationIndex.
constexpr double Camera::*kOfLens[kLensSize] = {
    &Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1,
    &Camera::k2, &Camera::k3, &Camera::k4, &Camera::p1, &Camera::p2};

// A camera as parameters: its lens, and no error in corrected depth.
CalibrationVector ThetaOf(const Camera& camera) {
  CalibrationVector theta = CalibrationVector::Zero();
  for (int k = 0; k < kLensSize; ++k) theta[k] = camera.*kOfLens[k];
  theta[kDepthFactor] = 1.0;
  return theta;
}

// Solves, measures the scales of the residuals, and does both again if the
// scales have changed.
void SolveWithScales(const BundleAdjustment& problem, const FreeParts& is_free,
                     CalibrationState* state) {
  const double pixel = state->pixel_scale, depth = state->depth_scale;
  const double cost = problem.Solve(is_free, state);
  problem.MeasureScales(state);
  constexpr double kSame = 0.02;
  const bool is_same = std::abs(state->pixel_scale / pixel - 1.0) < kSame &&
                       std::abs(state->depth_scale / depth - 1.0) < kSame;
  if (is_same || !std::isfinite(cost)) return;
  problem.Solve(is_free, state);
  problem.MeasureScales(state);
}

// Parameters that are determined together, the best determined groups first:
// the first one of each and their number.
constexpr std::pair<int, int> kGroups[] = {
    {kFx, 2},        {kK3, kLensSize - kK3}, {kK1, 2},
    {kCx, 2},        {kDepthFactor, 1},      {kInverseDepth, 1},
    {kRotationX, 6}, {kColorReadout, 2},     {kDepthTime, 1},
};

// Halves that differ by more than this times their error bars are in conflict.
constexpr double kMaxSpread = 4.0;

// The steps of Calibrate and what they share.
struct CalibrationSteps {
  // These are the arguments of Calibrate.
  const KeyframeMap& map;
  const RgbdCamera& first;
  const FrontendOptions& features;  // for this camera
  const CalibrationSettings& settings;
  const int threads;
  const FreeParts found_earlier;
  const std::function<void()> on_iteration;

  CalibrationData data = {};
  CalibrationVector undone = CalibrationVector::Zero();  // in depths of `data`
  CalibrationPrior prior = {};
  CalibrationVector start = {};        // theta of the first camera
  CalibrationViews views_before = {};  // with depths as first looked up
  CalibrationState before = {};        // the solution with the first camera
  CalibrationState after = {};         // the solution with free parameters
  FreeParts asked = {};                // may be free
  FreeParts needed = {};      // of these: held-out pairs fit better with them
  FreeParts determined = {};  // of these: better known than from the prior
  CalibrationResult result = {};

  // The problem without the held-out pairs.
  BundleAdjustment Training(
      int max_iterations = BundleAdjustment::kMaxIterations) const {
    return {data.views, prior, true, max_iterations, on_iteration};
  }

  void Collect(const Trajectory& path, const CalibrationScale& scale,
               const RgbdCamera& known) {
    result.camera = result.found = first;
    data = CollectCalibrationData(map, path, features, settings.max_views,
                                  threads);
    result.scale_from =
        AddKnownDistances(path, settings.known_length, scale, &data);
    result.keyframes = static_cast<int>(data.timestamps.size());
    result.pairs = static_cast<int>(data.pairs.size());
    result.landmarks = static_cast<int>(data.views.landmarks.size());
    result.views = static_cast<int>(data.views.views.size());
    start = ThetaOf(map.camera);
    prior.mean = ThetaBetween(first, known);
    const CalibrationVector values = CameraValues(first, first);
    asked = FreeParameters(settings.fix, !data.views.distances.empty(),
                           map.camera.lens_model);
    for (int k = 0; k < kCalibrationSize; ++k) {
      prior.sigma[k] = kCalibrationParameters[k].prior;
      if (k == kFx || k == kFy) prior.sigma[k] *= start[k];
      CalibratedParameter& parameter = result.parameters[k];
      parameter.before = parameter.found = values[k];
      parameter.prior = parameter.sigma = prior.sigma[k];
      if (asked[k]) parameter.status = Status::kUndetermined;
    }
  }

  void SolveWithFirstCamera() {
    views_before = data.views;
    before = Training().Begin(start);
    Training().MeasureScales(&before);
    SolveWithScales(Training(), FreeParts{}, &before);
    result.noise = result.noise_before =
        FitDepthNoise(views_before, before, features.depth.noise);
  }

  // Higher lens coefficients are free only if held-out pairs gain enough.
  void SolveForAsked() {
    constexpr double kHigherSigmas = 9.0;  // see docs/calibration.md
    needed = asked;
    for (int k = kK3; k < kLensSize; ++k) needed[k] = false;
    after = before;
    SolveWithScales(Training(), needed, &after);
    if (needed == asked) return;
    CalibrationState higher = after;
    SolveWithScales(Training(), asked, &higher);
    CalibrationResult compared;
    CompareHeldOut(data.views, after, data.views, higher, &compared);
    if (compared.gain_sigmas < kHigherSigmas) return;
    after = higher;
    needed = asked;
  }

  // While the solution displaces depth, looks it up again and solves again.
  void LookUpDisplacedDepths(int max_rounds) {
    for (int i = 0; i < max_rounds && IsDisplaced(after.theta - undone); ++i) {
      undone = after.theta;
      LookUpDepthsAgain(map, ApplyCalibration(first, undone).camera,
                        features.depth, undone, threads, &data);
      SolveWithScales(Training(), needed, &after);
    }
  }

  // Resets parameters that do not improve the fit of held-out pairs: they
  // compensate each other, or something other than the camera.
  void ResetUnneeded() {
    // Errors may exceed the scatter of pairs as much as those of the halves.
    const double spread =
        std::clamp(SpreadOfHalves(SplitHalfConsistency(
                       data.views, after, needed, prior, on_iteration)),
                   1.0, kMaxSpread);
    constexpr int kNearby = 5;  // iterations; few, as the start is a solution
    const BundleAdjustment nearby = Training(kNearby);
    CalibrationState best = after;
    for (const auto& [begin, size] : kGroups) {
      FreeParts fewer = needed;
      CalibrationState simpler = after;
      for (int k = begin; k < begin + size; ++k) {
        fewer[k] = false;
        simpler.theta[k] = start[k];
      }
      if (fewer == needed) continue;
      nearby.Solve(fewer, &simpler);
      nearby.MeasureScales(&simpler);
      CalibrationResult compared;
      CompareHeldOut(data.views, simpler, data.views, best, &compared);
      if (compared.held_out_pairs < 2) return;
      if (compared.gain_sigmas >= spread * kMinSigmas) continue;
      if (compared.gain_sigmas < 0.0) best = simpler;
      needed = fewer;
      after = simpler;
    }
  }

  // The difference of the halves shows how wide the error bars have to be.
  void CompareHalves() {
    const FreeParts changed = needed | found_earlier;
    if (changed.none()) return;
    result.halves =
        SplitHalfConsistency(data.views, after, changed, prior, on_iteration);
    const double spread = SpreadOfHalves(result.halves);
    result.halves_spread = spread > kMaxSpread ? 1.0 : std::max(1.0, spread);
    for (HalvesOfParameter& half : result.halves) {
      half.sigma *= result.halves_spread;
    }
  }

  // Takes needed parameters and their error bars from the solution.
  void TakeParameters(const BundleAdjustment& problem) {
    const auto variances = problem.Variances(needed, after);
    const CalibrationVector values =
        CameraValues(first, ApplyCalibration(first, after.theta));
    for (int k = 0; k < kCalibrationSize; ++k) {
      if (!needed[k]) continue;
      CalibratedParameter& parameter = result.parameters[k];
      parameter.found = values[k];
      parameter.sigma =
          variances.has_value()
              ? std::hypot(result.halves_spread * std::sqrt((*variances)[k]),
                           CalibrationFloor(k, result.keyframes))
              : prior.sigma[k];
    }
  }

  void FindDetermined() {
    TakeParameters(Training());
    for (int k = 0; k < kCalibrationSize; ++k) {
      CalibratedParameter& parameter = result.parameters[k];
      determined[k] = needed[k] && parameter.sigma < settings.determined_share *
                                                         parameter.prior;
      if (determined[k]) parameter.status = Status::kDetermined;
    }
  }

  void ResetUndetermined() {
    if (determined == needed) return;
    for (int k = 0; k < kCalibrationSize; ++k) {
      if (!determined[k]) after.theta[k] = start[k];
    }
    std::vector<HalvesOfParameter> halves;
    for (const HalvesOfParameter& half : result.halves) {
      if ((determined | found_earlier)[half.part]) halves.push_back(half);
    }
    result.halves = halves;
    SolveWithScales(Training(), determined, &after);
  }

  void CompareWithFirstCamera(const Trajectory* ground_truth) {
    if (ground_truth != nullptr) {
      result.truth_before = TruthError(data, before, *ground_truth);
      result.truth_after = TruthError(data, after, *ground_truth);
    }
    CalibrationResult with_map_poses;
    CompareHeldOut(views_before, Training().Begin(start), data.views, after,
                   &with_map_poses);
    result.cost_of_map = with_map_poses.cost_before;
    CompareHeldOut(views_before, before, data.views, after, &result);
    CompareOnUnseen(views_before, before, data.views, after, determined, prior,
                    on_iteration, &result);
  }

  void SolveWithAllPairs() {
    const BundleAdjustment all(data.views, prior, false,
                               BundleAdjustment::kMaxIterations, on_iteration);
    SolveWithScales(all, determined, &after);
    TakeParameters(all);
    result.displacement_px = DisplacementPx(data.views, after.theta - start);
    result.pixel_before = before.pixel_scale;
    result.pixel_after = after.pixel_scale;
    result.depth_before = before.depth_scale;
    result.depth_after = after.depth_scale;
    result.found = ApplyCalibration(first, after.theta);
  }

  void AcceptOrReject() {
    std::string why_not = WhyNoBetter(first, settings, result);
    result.is_better = why_not.empty();
    if (result.is_better) {
      result.noise_found =
          FitDepthNoise(data.views, after, features.depth.noise);
      why_not = WhyUnchecked(settings, result);
    }
    result.Conclude(first, why_not);
  }
};

}  // namespace

CalibrationResult Calibrate(
    const KeyframeMap& map, const Trajectory& path, const RgbdCamera& first,
    const OdometrySettings& odometry, const CalibrationSettings& settings,
    const CalibrationScale& scale, int threads, const RgbdCamera* known,
    const FreeParts& found_earlier, const std::function<void()>& on_iteration) {
  RequireSound(settings.Check(), "calibration: ");
  FrontendOptions features = FeaturesFor(odometry, first);
  // The spread of pixels is measured relative to what the frontend states.
  features.feature_noise = 1.0;
  CalibrationSteps steps{map,     first,         features,    settings,
                         threads, found_earlier, on_iteration};
  CalibrationResult& result = steps.result;
  steps.Collect(path, scale, known != nullptr ? *known : first);
  constexpr int kMinViews = 100;
  if (result.views < kMinViews) {
    result.reason = "the camera hardly moved or was lost: only " +
                    std::to_string(result.views) + " landmark views in " +
                    std::to_string(result.keyframes) + " keyframes of " +
                    std::to_string(path.size()) +
                    " tracked frames; rgbd_odometry says which frames are lost";
    return result;
  }
  steps.SolveWithFirstCamera();
  steps.SolveForAsked();
  steps.LookUpDisplacedDepths(/*max_rounds=*/4);
  steps.ResetUnneeded();
  steps.LookUpDisplacedDepths(/*max_rounds=*/1);
  steps.CompareHalves();
  if (steps.needed.none()) {
    result.reason = steps.asked.none() ? "all parameters are fixed"
                                       : "no error found: held-out pairs fit "
                                         "no better with another camera";
    return result;
  }
  steps.FindDetermined();
  if (steps.determined.none()) {
    result.reason = "the recording determines none of the camera's parameters";
    return result;
  }
  steps.ResetUndetermined();
  steps.CompareWithFirstCamera(scale.ground_truth);
  steps.SolveWithAllPairs();
  steps.AcceptOrReject();
  return result;
}

RgbdCamera ApplyCalibration(const RgbdCamera& first,
                            const CalibrationVector& theta) {
  RgbdCamera changed = first;
  Camera& camera = changed.camera;
  for (int k = 0; k < kLensSize; ++k) camera.*kOfLens[k] = theta[k];
  changed.depth_scale = first.depth_scale / theta[kDepthFactor];
  changed.depth_correction.inverse_depth_offset =
      first.depth_correction.inverse_depth_offset / theta[kDepthFactor] +
      theta[kInverseDepth];
  changed.depth_shutter.offset += theta[kDepthTime];
  changed.depth_shutter.readout += theta[kDepthReadout];
  changed.color_shutter.readout += theta[kColorReadout];
  changed.depth_correction.depth_from_color =
      first.depth_correction.depth_from_color *
      Rigid3d::FromRotationVector(theta.segment<3>(kRotationX),
                                  theta.segment<3>(kTranslationX));
  return changed;
}

CalibrationVector ThetaBetween(const RgbdCamera& first,
                               const RgbdCamera& changed) {
  CalibrationVector theta = ThetaOf(changed.camera);
  theta[kDepthFactor] = first.depth_scale / changed.depth_scale;
  const DepthCorrection& before = first.depth_correction;
  const DepthCorrection& after = changed.depth_correction;
  theta[kInverseDepth] = after.inverse_depth_offset -
                         before.inverse_depth_offset / theta[kDepthFactor];
  theta[kDepthTime] = changed.depth_shutter.offset - first.depth_shutter.offset;
  theta[kDepthReadout] =
      changed.depth_shutter.readout - first.depth_shutter.readout;
  theta[kColorReadout] =
      changed.color_shutter.readout - first.color_shutter.readout;
  const Rigid3d moved =
      before.depth_from_color.Inverse() * after.depth_from_color;
  theta.segment<3>(kRotationX) = RotationVector(moved.rotation);
  theta.segment<3>(kTranslationX) = moved.translation;
  return theta;
}

CalibrationVector CameraValues(const RgbdCamera& first,
                               const RgbdCamera& changed) {
  RgbdCamera uncorrected;
  uncorrected.depth_scale = first.depth_scale;
  return ThetaBetween(uncorrected, changed);
}

}  // namespace rgbd_pose
