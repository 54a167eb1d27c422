#include "apps/pipeline/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "apps/pipeline/calibration_scale.h"
#include "apps/pipeline/calibration_verdict.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

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

CalibrationVector ThetaOf(const Camera& camera) {
  CalibrationVector theta = CalibrationVector::Zero();
  theta[kFx] = camera.fx;
  theta[kFy] = camera.fy;
  theta[kCx] = camera.cx;
  theta[kCy] = camera.cy;
  theta[kK1] = camera.k1;
  theta[kK2] = camera.k2;
  theta[kDepthFactor] = 1.0;
  return theta;
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

// The first camera as theta changes it.
RgbdCamera Changed(const RgbdCamera& first, const CalibrationVector& theta) {
  RgbdCamera changed = first;
  Camera& camera = changed.camera;
  camera.fx = theta[kFx];
  camera.fy = theta[kFy];
  camera.cx = theta[kCx];
  camera.cy = theta[kCy];
  camera.k1 = theta[kK1];
  camera.k2 = theta[kK2];
  changed.depth_scale = first.depth_scale / theta[kDepthFactor];
  changed.depth_errors.inverse_depth_offset =
      first.depth_errors.inverse_depth_offset / theta[kDepthFactor] +
      theta[kInverseDepth];
  changed.depth_errors.depth_time_offset =
      first.depth_errors.depth_time_offset + theta[kDepthTime];
  const Eigen::Vector3d turn = theta.segment<3>(kRotationX);
  const double angle = turn.norm();
  const Eigen::Vector3d axis =
      angle > 0.0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitX();
  changed.depth_errors.depth_from_color =
      first.depth_errors.depth_from_color *
      Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)),
              theta.segment<3>(kTranslationX));
  return changed;
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
  result.camera = first;
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

  const CalibrationVector start = ThetaOf(map.camera);
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

  // What pairs tell that are not held out, with both cameras.
  constexpr int kRounds = 3;
  const LandmarkProblem training(data.views, start, prior, true, solve);
  CalibrationState before = training.Begin();
  training.MeasureScales(&before);
  SolveWithScales(training, FreeParts{}, kRounds, &before);
  CalibrationState after = before;
  SolveWithScales(training, asked, kRounds, &after);
  const CalibrationViews views_before = data.views;
  if (IsDisplaced(after.theta)) {
    LookUpDepthsAnew(map, Changed(first, after.theta).camera, odometry,
                     after.theta, threads, &data);
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
                         kCalibrationParameters[k].floor)
                   : prior[k];
      is_free[k] =
          parameter.sigma < settings.determined_share * parameter.prior;
      parameter.fate = is_free[k] ? Fate::kDetermined : Fate::kUndetermined;
    }
  };
  judge(training, after);
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
  result.pixel_before = before.pixel_scale;
  result.pixel_after = found.pixel_scale;
  result.depth_before = before.depth_scale;
  result.depth_after = found.depth_scale;
  const RgbdCamera changed = Changed(first, found.theta);
  result.reason = WhyNot(first, changed, settings, result);
  if (!result.reason.empty()) return result;
  result.is_accepted = true;
  result.camera = changed;
  return result;
}

}  // namespace rgbd_pose
