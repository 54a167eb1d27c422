#include "apps/calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "apps/calibration/calibration_camera.h"
#include "apps/calibration/calibration_halves.h"
#include "apps/calibration/calibration_scale.h"
#include "apps/calibration/calibration_verdict.h"
#include "apps/calibration/displaced_depths.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

using FreeParts = std::array<bool, kCalibrationSize>;
using Fate = CalibratedParameter::Fate;

struct NamedParts {
  const char* name;
  std::vector<int> parts;
};

std::vector<NamedParts> PartNames() {
  std::vector<NamedParts> names = {
      {"focal", {kFx, kFy}},
      {"centre", {kCx, kCy}},
      {"distortion", {kK1, kK2}},
      {"registration",
       {kRotationX, kRotationY, kRotationZ, kTranslationX, kTranslationY,
        kTranslationZ}},
  };
  for (int k = 0; k < kCalibrationSize; ++k) {
    names.push_back({kCalibrationParameters[k].name, {k}});
  }
  return names;
}

// All but what is fixed; depth_factor only where something gives a scale.
FreeParts FreePartsOf(const std::string& fix, bool has_scale) {
  FreeParts is_free;
  is_free.fill(true);
  is_free[kDepthFactor] = has_scale;
  const std::vector<NamedParts> names = PartNames();
  std::stringstream list(fix);
  for (std::string word; std::getline(list, word, ',');) {
    const auto named =
        std::find_if(names.begin(), names.end(),
                     [&](const NamedParts& n) { return n.name == word; });
    if (named == names.end()) {
      std::string known;
      for (const NamedParts& n : names) {
        known += (known.empty() ? "" : ", ") + std::string(n.name);
      }
      throw InputError("fix: there is no parameter '" + word + "'; there are " +
                       known);
    }
    for (const int part : named->parts) is_free[part] = false;
  }
  return is_free;
}

CalibrationVector PriorOf(const CalibrationSettings& settings,
                          const CalibrationVector& start) {
  CalibrationVector prior;
  for (int k = 0; k < kCalibrationSize; ++k) {
    prior[k] = settings.prior[k] > 0.0 ? settings.prior[k]
                                       : kCalibrationParameters[k].prior;
    if (k == kFx || k == kFy) prior[k] *= start[k];
  }
  return prior;
}

// Whether depth has to be looked up elsewhere.
bool IsDisplaced(const CalibrationVector& theta) {
  constexpr double kRotation = 5e-4;     // rad
  constexpr double kTranslation = 1e-3;  // m
  constexpr double kDelay = 5e-4;        // s
  return theta.segment<3>(kRotationX).norm() > kRotation ||
         theta.segment<3>(kTranslationX).norm() > kTranslation ||
         std::abs(theta[kDepthTime]) > kDelay;
}

// How far a change of theta displaces depth in the image: the median of
// landmarks.
double DisplacementPx(const CalibrationViews& views,
                      const CalibrationVector& change) {
  std::vector<double> all;
  for (const Landmark& landmark : views.landmarks) {
    const MeasuredInverseDepth& at = landmark.depth;
    const Eigen::Vector3d turn =
        change.segment<3>(kRotationX) + change[kDepthTime] * at.rate_rotation;
    const Eigen::Vector3d shift = change.segment<3>(kTranslationX) +
                                  change[kDepthTime] * at.rate_translation;
    const Eigen::Vector3d moved = turn.cross(at.ray) + at.value * shift;
    all.push_back(views.camera.fx *
                  (moved - moved.z() * at.ray).head<2>().norm());
  }
  return all.empty() ? 0.0 : Median(all);
}

// Solves, and takes the scales of what is left, until they stay.
void SolveWithScales(const LandmarkProblem& problem, const FreeParts& is_free,
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

}  // namespace

std::string CalibrationSettings::Check() const {
  if (!(determined_share > 0.0 && determined_share <= 1.0)) {
    return "determined_share must be above 0 and at most 1";
  }
  if (!(min_gain >= 0.0) || !(min_gain_sigmas >= 0.0)) {
    return "what held-out pairs have to gain must not be negative";
  }
  if (!(max_halves_sigmas > 0.0)) return "max_halves_sigmas must be positive";
  if (!(max_rate >= 0.0)) return "max_rate must not be negative";
  if (max_passes < 1 || max_passes > 10) return "max_passes must be 1 to 10";
  if (!prior.allFinite() || !(prior.array() >= 0.0).all()) {
    return "standard deviations must not be negative";
  }
  try {
    FreePartsOf(fix, false);
  } catch (const InputError& error) {
    return error.what();
  }
  return data.Check();
}

std::vector<Setting> SettingTable(CalibrationSettings* settings) {
  constexpr std::string_view kGroup = "Calibration";
  return {
      {"fix", kGroup,
       "what is to stay as it is, separated by commas: focal, centre, "
       "distortion, registration, or a parameter's name",
       Text(&settings->fix)},
      {"known_length", kGroup,
       "gives depth a scale: T0,T1,METRES, two time stamps (s) and how far "
       "apart the camera was then",
       Text(&settings->known_length)},
      {"determined_share", kGroup,
       "a parameter is determined if the recording reduces its standard "
       "deviation to this share of the prior's",
       &settings->determined_share},
      {"min_gain", kGroup,
       "share of their cost that held-out pairs must gain for another camera "
       "to be taken",
       &settings->min_gain},
      {"max_halves_sigmas", kGroup,
       "what both halves of a recording say by themselves may differ by so "
       "many "
       "standard deviations",
       &settings->max_halves_sigmas},
      {"max_rate", kGroup,
       "of a recording with more frames a second every second one is left out, "
       "or more, unless --frames says which; 0: none",
       &settings->max_rate},
      {"max_passes", kGroup,
       "a recording whose depth turns out to be displaced by pixels is mapped "
       "anew with the camera found, so many times at most",
       &settings->max_passes},
      {"max_views", kGroup,
       "views of landmarks that are solved for, about: the time it takes grows "
       "with it",
       &settings->data.max_views},
  };
}

CalibrationResult Calibrate(const KeyframeMap& map, const Trajectory& path,
                            const RgbdCamera& first,
                            const OdometrySettings& odometry,
                            const CalibrationSettings& settings,
                            const CalibrationScale& scale, int threads) {
  const std::string error = settings.Check();
  if (!error.empty()) throw InputError("calibration: " + error);
  CalibrationResult result;
  result.camera = result.found = first;
  CalibrationData data =
      CollectCalibrationData(map, path, odometry, settings.data, threads);
  result.scale_from =
      AddKnownDistances(map, path, settings.known_length, scale, &data);
  const FreeParts asked =
      FreePartsOf(settings.fix, !data.views.distances.empty());
  result.keyframes = static_cast<int>(data.timestamps.size());
  result.pairs = static_cast<int>(data.pairs.size());
  result.landmarks = static_cast<int>(data.views.landmarks.size());
  result.views = static_cast<int>(data.views.views.size());

  CalibrationVector start = ThetaOf(map.camera);
  start[kDepthTime] = settings.known_delay;
  const CalibrationVector prior = PriorOf(settings, start);
  for (int k = 0; k < kCalibrationSize; ++k) {
    CalibratedParameter& parameter = result.parameters[k];
    parameter.before = parameter.found = start[k];
    parameter.prior = parameter.sigma = prior[k];
    if (asked[k]) parameter.fate = Fate::kUndetermined;
  }
  constexpr int kMinViews = 100;
  if (result.views < kMinViews) {
    result.reason = "the camera hardly moved: there are " +
                    std::to_string(result.views) + " views of the same from " +
                    std::to_string(result.keyframes) + " keyframes";
    return result;
  }
  LandmarkProblemOptions solve = settings.solve;
  solve.threads = threads;

  CalibrationVector undone = CalibrationVector::Zero();
  const auto look_up = [&](const CalibrationVector& theta) {
    undone = theta;
    LookUpDepthsAnew(map, Changed(first, theta).camera, odometry, theta,
                     threads, &data);
  };
  if (IsDisplaced(start)) look_up(start);

  // What pairs tell that are not held out, with both cameras.
  constexpr int kRounds = 2;
  const LandmarkProblem training(data.views, start, prior, true, solve);
  CalibrationState before = training.Begin();
  training.MeasureScales(&before);
  SolveWithScales(training, FreeParts{}, kRounds, &before);
  CalibrationState after = before;
  SolveWithScales(training, asked, kRounds, &after);
  const CalibrationViews views_before = data.views;
  constexpr int kMostLookUps = 4;
  for (int i = 0; i < kMostLookUps && IsDisplaced(after.theta - undone); ++i) {
    look_up(after.theta);
    SolveWithScales(training, asked, kRounds, &after);
  }
  CalibrationMatrix by_noise, by_scatter;
  FreeParts is_free = asked;
  const auto judge = [&](const LandmarkProblem& problem,
                         const CalibrationState& state) {
    const bool can_tell =
        problem.Covariance(asked, state, &by_noise, &by_scatter);
    for (int k = 0; k < kCalibrationSize; ++k) {
      if (!asked[k]) continue;
      CalibratedParameter& parameter = result.parameters[k];
      parameter.found = state.theta[k];
      parameter.sigma =
          can_tell ? std::hypot(
                         std::sqrt(std::max(by_noise(k, k), by_scatter(k, k))),
                         CalibrationFloor(k, result.keyframes))
                   : prior[k];
      is_free[k] =
          parameter.sigma < settings.determined_share * parameter.prior;
      parameter.fate = is_free[k] ? Fate::kDetermined : Fate::kUndetermined;
    }
  };
  judge(training, after);
  result.noise =
      FitDepthNoise(views_before, before, odometry.features.depth_noise);
  if (std::none_of(is_free.begin(), is_free.end(), [](bool b) { return b; })) {
    result.reason = "the recording determines nothing of it";
    return result;
  }
  if (is_free != asked) {
    // The rest stays where it was.
    for (int k = 0; k < kCalibrationSize; ++k) {
      if (!is_free[k]) after.theta[k] = start[k];
    }
    SolveWithScales(training, is_free, kRounds, &after);
  }
  if (scale.ground_truth != nullptr) {
    result.truth_before = TruthError(data, before, *scale.ground_truth);
    result.truth_after = TruthError(data, after, *scale.ground_truth);
  }
  CompareHeldOut(views_before, before, data.views, after,
                 settings.solve.loss_width, &result);

  // And in the end all.
  const LandmarkProblem all(data.views, start, prior, false, solve);
  CalibrationState found = after;
  SolveWithScales(all, is_free, kRounds, &found);
  const FreeParts determined = is_free;
  judge(all, found);
  for (int k = 0; k < kCalibrationSize; ++k) {
    if (asked[k] && !determined[k]) {
      result.parameters[k].fate = Fate::kUndetermined;
    }
  }
  result.halves =
      CompareHalves(data.views, found, is_free, start, prior, solve);
  result.displacement_px = DisplacementPx(data.views, found.theta - start);
  result.pixel_before = before.pixel_scale;
  result.pixel_after = found.pixel_scale;
  result.depth_before = before.depth_scale;
  result.depth_after = found.depth_scale;
  result.found = Changed(first, found.theta);
  result.reason = WhyNot(first, result.found, settings, result);
  if (!result.reason.empty()) return result;
  result.is_accepted = true;
  result.camera = result.found;
  result.noise =
      FitDepthNoise(data.views, found, odometry.features.depth_noise);
  return result;
}

}  // namespace rgbd_pose
