#include "apps/calibration/calibration.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/calibration/calibration_verdict.h"
#include "apps/calibration/displaced_depths.h"
#include "core/util/input_error.h"
#include "costs/calibration/bundle_adjustment.h"

namespace rgbd_pose {
namespace {

using Status = CalibratedParameter::Status;

// In the order of CalibrationIndex.
constexpr double Camera::*kOfLens[kLensSize] = {
    &Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1,
    &Camera::k2, &Camera::k3, &Camera::k4, &Camera::p1, &Camera::p2};

// A camera as calibration parameters: its lens, and no error in corrected
// depth.
CalibrationVector ThetaOf(const Camera& camera) {
  CalibrationVector theta = CalibrationVector::Zero();
  for (int k = 0; k < kLensSize; ++k) theta[k] = camera.*kOfLens[k];
  theta[kDepthFactor] = 1.0;
  return theta;
}

CalibrationVector PriorSigmas(const CalibrationVector& start) {
  CalibrationVector prior;
  for (int k = 0; k < kCalibrationSize; ++k) {
    prior[k] = kCalibrationParameters[k].prior;
    if (k == kFx || k == kFy) prior[k] *= start[k];
  }
  return prior;
}

// Alternates between solving and measuring the scales of the residuals until
// the scales converge.
void SolveWithScales(const BundleAdjustment& problem, const FreeParts& is_free,
                     int rounds, CalibrationState* state) {
  constexpr double kSame = 0.02;
  for (int round = 0; round < rounds; ++round) {
    const double pixel = state->pixel_scale, depth = state->depth_scale;
    const double cost = problem.Solve(is_free, state);
    problem.MeasureScales(state);
    if (!std::isfinite(cost)) return;
    if (std::abs(state->pixel_scale / pixel - 1.0) < kSame &&
        std::abs(state->depth_scale / depth - 1.0) < kSame) {
      return;
    }
  }
}

// Returns by how many standard deviations the second state fits held-out pairs
// better; nothing if there are too few of them.
std::optional<double> GainSigmas(const CalibrationViews& views,
                                 const CalibrationState& before,
                                 const CalibrationState& after) {
  CalibrationResult compared;
  CompareHeldOut(views, before, views, after, &compared);
  if (compared.held_out_pairs < 2) return std::nullopt;
  return compared.gain_sigmas;
}

// The higher lens coefficients are free only if the held-out pairs improve by
// at least this many standard deviations. Where these coefficients were wrong,
// the gain was 12 and 25 standard deviations. Where they were right, but a hand
// moved unevenly within a frame, the gain was 4 to 7.
constexpr double kHigherSigmas = 9.0;
constexpr int kNumHigher = kLensSize - kK3;

// Solves without the higher lens coefficients, then with them, and keeps them
// if the gain is large enough. Returns which parameters were free.
FreeParts SolveWithLensAsked(const BundleAdjustment& training,
                             const CalibrationViews& views,
                             const FreeParts& asked, int rounds,
                             CalibrationState* state) {
  FreeParts is_free = asked;
  for (int k = kK3; k < kLensSize; ++k) is_free[k] = false;
  SolveWithScales(training, is_free, rounds, state);
  if (is_free == asked) return is_free;
  CalibrationState higher = *state;
  SolveWithScales(training, asked, rounds, &higher);
  if (GainSigmas(views, *state, higher).value_or(0.0) < kHigherSigmas) {
    return is_free;
  }
  *state = higher;
  return asked;
}

// Parameters that are determined together, the best determined groups first.
struct Group {
  int first, size;
};
constexpr Group kGroups[] = {
    {kFx, 2},        {kK3, kNumHigher},  {kK1, 2},
    {kCx, 2},        {kDepthFactor, 1},  {kInverseDepth, 1},
    {kRotationX, 6}, {kColorReadout, 2}, {kDepthTime, 1},
};

// Resets parameters that the held-out pairs do not need. Parameters that
// compensate each other, or something other than the camera, do not improve the
// fit of these pairs. `spread` is the factor by which errors may exceed the
// scatter of the pairs.
void ResetUnneeded(const CalibrationViews& views, const CalibrationPrior& prior,
                   const CalibrationVector& start, double spread,
                   FreeParts* is_free, CalibrationState* state) {
  constexpr int kNearby = 5;  // iterations; few, as the start is a solution
  const BundleAdjustment training(views, prior, true, kNearby);
  CalibrationState best = *state;
  for (const Group& group : kGroups) {
    FreeParts fewer = *is_free;
    CalibrationState simpler = *state;
    for (int k = group.first; k < group.first + group.size; ++k) {
      fewer[k] = false;
      simpler.theta[k] = start[k];
    }
    if (fewer == *is_free) continue;
    SolveWithScales(training, fewer, 1, &simpler);
    const std::optional<double> gain = GainSigmas(views, simpler, best);
    if (!gain.has_value()) return;
    if (*gain >= spread * kMinSigmas) continue;
    if (*gain < 0.0) best = simpler;
    *is_free = fewer;
    *state = simpler;
  }
}

}  // namespace

CalibrationResult Calibrate(const KeyframeMap& map, const Trajectory& path,
                            const RgbdCamera& first,
                            const OdometrySettings& odometry,
                            const CalibrationSettings& settings,
                            const CalibrationScale& scale, int threads,
                            const RgbdCamera* known) {
  RequireSound(settings.Check(), "calibration: ");
  CalibrationResult result;
  result.camera = result.found = first;
  CalibrationData data =
      CollectCalibrationData(map, path, odometry, settings.max_views, threads);
  result.scale_from =
      AddKnownDistances(path, settings.known_length, scale, &data);
  result.keyframes = static_cast<int>(data.timestamps.size());
  result.pairs = static_cast<int>(data.pairs.size());
  result.landmarks = static_cast<int>(data.views.landmarks.size());
  result.views = static_cast<int>(data.views.views.size());
  const CalibrationVector start = ThetaOf(map.camera);
  CalibrationPrior prior;
  prior.mean = ThetaBetween(first, known != nullptr ? *known : first);
  prior.sigma = PriorSigmas(start);
  const FreeParts asked = FreeParameters(
      settings.fix, !data.views.distances.empty(), map.camera.lens_model);
  for (int k = 0; k < kCalibrationSize; ++k) {
    CalibratedParameter& parameter = result.parameters[k];
    parameter.before = parameter.found = start[k];
    parameter.prior = parameter.sigma = prior.sigma[k];
    if (asked[k]) parameter.status = Status::kUndetermined;
  }
  constexpr int kMinViews = 100;
  if (result.views < kMinViews) {
    result.reason = "the camera hardly moved: only " +
                    std::to_string(result.views) + " landmark views in " +
                    std::to_string(result.keyframes) + " keyframes";
    return result;
  }

  CalibrationVector undone = CalibrationVector::Zero();
  const auto look_up = [&](const CalibrationVector& theta) {
    undone = theta;
    LookUpDepthsAgain(map, ApplyCalibration(first, theta).camera, odometry,
                      theta, threads, &data);
  };

  // Solve for the training pairs (not held out) with both cameras.
  constexpr int kRounds = 2;
  const BundleAdjustment training(data.views, prior, true);
  CalibrationState before = training.Begin(start);
  training.MeasureScales(&before);
  SolveWithScales(training, FreeParts{}, kRounds, &before);
  CalibrationState after = before;
  FreeParts is_free =
      SolveWithLensAsked(training, data.views, asked, kRounds, &after);
  const CalibrationViews views_before = data.views;
  constexpr int kMostLookUps = 4;
  for (int i = 0; i < kMostLookUps && IsDisplaced(after.theta - undone); ++i) {
    look_up(after.theta);
    SolveWithScales(training, is_free, kRounds, &after);
  }
  result.noise =
      FitDepthNoise(views_before, before, odometry.features.depth_noise);
  // The difference of the halves shows how wide the error bars have to be.
  // Beyond this factor, the halves contradict each other.
  constexpr double kMaxSpread = 4.0;
  const double spread_of_all =
      SpreadOfHalves(SplitHalfConsistency(data.views, after, is_free, prior));
  ResetUnneeded(data.views, prior, start,
                std::clamp(spread_of_all, 1.0, kMaxSpread), &is_free, &after);
  if (IsDisplaced(after.theta - undone)) {
    look_up(after.theta);
    SolveWithScales(training, is_free, kRounds, &after);
  }
  if (is_free.none()) {
    result.reason = asked.none() ? "all parameters are fixed"
                                 : "no error found: held-out pairs fit no "
                                   "better with another camera";
    return result;
  }
  result.halves = SplitHalfConsistency(data.views, after, is_free, prior);
  const double spread = SpreadOfHalves(result.halves);
  result.halves_spread = spread > kMaxSpread ? 1.0 : std::max(1.0, spread);
  for (HalvesOfParameter& half : result.halves) {
    half.sigma *= result.halves_spread;
  }
  const FreeParts needed = is_free;
  const auto judge = [&](const BundleAdjustment& problem,
                         const CalibrationState& state) {
    const auto variances = problem.Variances(needed, state);
    for (int k = 0; k < kCalibrationSize; ++k) {
      if (!needed[k]) continue;
      CalibratedParameter& parameter = result.parameters[k];
      parameter.found = state.theta[k];
      parameter.sigma =
          variances.has_value()
              ? std::hypot(result.halves_spread * std::sqrt((*variances)[k]),
                           CalibrationFloor(k, result.keyframes))
              : prior.sigma[k];
    }
  };
  judge(training, after);
  for (int k = 0; k < kCalibrationSize; ++k) {
    CalibratedParameter& parameter = result.parameters[k];
    is_free[k] = needed[k] &&
                 parameter.sigma < settings.determined_share * parameter.prior;
    if (is_free[k]) parameter.status = Status::kDetermined;
  }
  if (is_free.none()) {
    result.reason = "the recording determines none of the camera's parameters";
    return result;
  }
  if (is_free != needed) {
    // The other parameters keep their start values.
    for (int k = 0; k < kCalibrationSize; ++k) {
      if (!is_free[k]) after.theta[k] = start[k];
    }
    std::vector<HalvesOfParameter> halves;
    for (const HalvesOfParameter& half : result.halves) {
      if (is_free[half.part]) halves.push_back(half);
    }
    result.halves = halves;
    SolveWithScales(training, is_free, kRounds, &after);
  }
  if (scale.ground_truth != nullptr) {
    result.truth_before = TruthError(data, before, *scale.ground_truth);
    result.truth_after = TruthError(data, after, *scale.ground_truth);
  }
  CalibrationResult with_map_poses;
  CompareHeldOut(views_before, training.Begin(start), data.views, after,
                 &with_map_poses);
  result.cost_of_map = with_map_poses.cost_before;
  CompareHeldOut(views_before, before, data.views, after, &result);

  // Finally solve with all pairs.
  const BundleAdjustment all(data.views, prior, false);
  CalibrationState found = after;
  SolveWithScales(all, is_free, kRounds, &found);
  judge(all, found);
  result.displacement_px = DisplacementPx(data.views, found.theta - start);
  result.pixel_before = before.pixel_scale;
  result.pixel_after = found.pixel_scale;
  result.depth_before = before.depth_scale;
  result.depth_after = found.depth_scale;
  result.found = ApplyCalibration(first, found.theta);
  result.reason = RejectionReason(first, result.found, settings, result);
  if (!result.reason.empty()) return result;
  result.is_accepted = true;
  result.camera = result.found;
  result.noise =
      FitDepthNoise(data.views, found, odometry.features.depth_noise);
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

}  // namespace rgbd_pose
