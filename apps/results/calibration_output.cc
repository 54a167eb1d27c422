#include "apps/results/calibration_output.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/calibration/calibration_verdict.h"

namespace rgbd_pose {
namespace {

// The parameters that were found as a table, and the names of the others.
std::string FormatParameters(const CalibrationResult& result) {
  std::string text =
      Format("%-22s %12s %12s %10s  %s\n", "", "before", "found", "+-", "");
  std::vector<std::string> undetermined;
  for (int k = 0; k < kCalibrationSize; ++k) {
    const CalibrationParameter& row = kCalibrationParameters[k];
    const CalibratedParameter& parameter = result.parameters[k];
    if (parameter.status == CalibratedParameter::Status::kFixed) continue;
    if (parameter.status == CalibratedParameter::Status::kUndetermined) {
      undetermined.emplace_back(row.name);
      continue;
    }
    text +=
        Format("%-22s %12s %12s %10s  %s\n", row.name,
               ShortNumber(parameter.before).c_str(),
               NumberTo(parameter.found, parameter.sigma).c_str(),
               NumberTo(parameter.sigma, parameter.sigma).c_str(), row.unit);
  }
  if (undetermined.empty()) return text;
  return text + Join(undetermined) +
         " are unchanged: the recording does not determine them, or held-out "
         "pairs fit no better with other values\n";
}

// How well the cameras fit the pairs that took no part in the calibration.
std::string FormatHeldOut(const CalibrationResult& result) {
  return Format(
             "%d held-out pairs: cost per view %.4g -> %.4g (%.1f standard "
             "deviations); spread of residuals %.3g -> %.3g px\n",
             result.held_out_pairs, result.cost_before, result.cost_after,
             result.gain_sigmas, 0.5 * result.pixel_before,
             0.5 * result.pixel_after) +
         WhatIsLeft(result) + "\n" + HalvesInWords(result) + "\n" +
         UnseenInWords(result) + "\n" +
         Format(
             "features scatter by %.3g times what the frontend states "
             "(--feature_noise)\n",
             result.pixel_after);
}

std::string FormatDepthNoise(const DepthNoiseFit& noise) {
  std::string text = Format(
      "depth noise: sigma(z) = %.3g m + %.4g z^2 / m (+- %.2g, %.2g; %d "
      "depths), %.3g times what was assumed\n",
      noise.model.constant, noise.model.quadratic, noise.constant_sigma,
      noise.quadratic_sigma, noise.samples, noise.in_old_sigmas);
  if (!noise.IsPlausible()) {
    text +=
        "this is too large for sensor noise: depth is displaced; do not use "
        "depth_noise.yaml\n";
  }
  return text;
}

nlohmann::json ParametersToJson(const CalibrationResult& result) {
  nlohmann::json all = nlohmann::json::array();
  for (int k = 0; k < kCalibrationSize; ++k) {
    const CalibrationParameter& row = kCalibrationParameters[k];
    const CalibratedParameter& parameter = result.parameters[k];
    all.push_back({{"name", row.name},
                   {"what", row.what},
                   {"unit", row.unit},
                   {"status", ToString(parameter.status)},
                   {"before", parameter.before},
                   {"prior_sigma", parameter.prior},
                   {"found", parameter.found},
                   {"sigma", parameter.sigma}});
  }
  return all;
}

nlohmann::json HalvesToJson(const std::vector<HalvesOfParameter>& halves) {
  nlohmann::json all = nlohmann::json::array();
  for (const HalvesOfParameter& half : halves) {
    all.push_back({{"name", kCalibrationParameters[half.part].name},
                   {"first", half.first},
                   {"second", half.second},
                   {"sigma", half.sigma}});
  }
  return all;
}

nlohmann::json DepthNoiseToJson(const DepthNoiseFit& fit) {
  nlohmann::json scatter = nlohmann::json::array();
  for (const DepthScatter& at : fit.scatter) {
    scatter.push_back({at.depth, at.sigma});
  }
  return {{"constant", fit.model.constant},
          {"constant_sigma", fit.constant_sigma},
          {"quadratic", fit.model.quadratic},
          {"quadratic_sigma", fit.quadratic_sigma},
          {"depths", fit.samples},
          {"in_old_sigmas", fit.in_old_sigmas},
          {"mean_share", fit.model.mean_share},
          {"depth_and_sigma", scatter}};
}

}  // namespace

const char* ToString(CalibratedParameter::Status status) {
  using Status = CalibratedParameter::Status;
  return status == Status::kFixed          ? "fixed"
         : status == Status::kUndetermined ? "not determined"
                                           : "determined";
}

RecordingCalibration CalibrateWithProgress(const SequenceSettings& sequence,
                                           const OdometrySettings& odometry,
                                           const SlamSettings& slam,
                                           const CalibrationSettings& settings,
                                           int threads) {
  std::optional<ProgressBar> bar;
  int shown = 0;
  RecordingCalibration calibration = CalibrateRecording(
      sequence, odometry, slam, settings, threads,
      [&](int pass, int done, int all) {
        if (pass != shown) {
          bar.emplace(pass == 1 ? "calibrating" : "calibrating again", all);
          shown = pass;
        }
        bar->Update(done);
      },
      [&](int /*pass*/, int done) {
        if (done == 1) bar.emplace("solving for the camera, iteration", 0);
        bar->Update(done);
      });
  Warn(calibration.left_out);
  return calibration;
}

std::string FormatCalibrationSummary(const CalibrationResult& result) {
  std::string text =
      Format("%d keyframes, %d pairs, %d landmarks in %d views%s\n",
             result.keyframes, result.pairs, result.landmarks, result.views,
             result.passes > 1
                 ? Format("; %d passes: images were displaced by %.1f px",
                          result.passes, result.displacement_px)
                       .c_str()
                 : "");
  text += FormatParameters(result);
  const bool has_scale = result.parameters[kDepthFactor].status ==
                         CalibratedParameter::Status::kDetermined;
  text += result.scale_from.empty()
              ? "depth_factor is unchanged: images do not contain the depth "
                "scale; give a known length, ground truth or motion guess to "
                "estimate it\n"
              : Format("depth scale %s %s\n",
                       has_scale ? "estimated from" : "compared with",
                       result.scale_from.c_str());
  if (result.held_out_pairs > 0) text += FormatHeldOut(result);
  if (result.noise.has_value()) text += FormatDepthNoise(*result.noise);
  text += result.is_accepted
              ? "the new camera is better: use camera.yaml\n"
              : "the first camera is kept: " + result.reason + "\n";
  return text;
}

nlohmann::json CalibrationToJson(const CalibrationResult& result) {
  nlohmann::json noise;
  if (result.noise.has_value()) noise = DepthNoiseToJson(*result.noise);
  return {{"accepted", result.is_accepted},
          {"reason", result.reason},
          {"parameters", ParametersToJson(result)},
          {"scale_from", result.scale_from},
          {"keyframes", result.keyframes},
          {"pairs", result.pairs},
          {"held_out_pairs", result.held_out_pairs},
          {"landmarks", result.landmarks},
          {"views", result.views},
          {"cost_before", result.cost_before},
          {"cost_after", result.cost_after},
          {"gain_sigmas", result.gain_sigmas},
          {"unseen_cost_before", result.unseen_before},
          {"unseen_cost_after", result.unseen_after},
          {"unseen_gain_sigmas", result.unseen_sigmas},
          {"truth_error_before", result.truth_before},
          {"truth_error_after", result.truth_after},
          {"pixel_spread_before", result.pixel_before},
          {"pixel_spread_after", result.pixel_after},
          {"depth_spread_before", result.depth_before},
          {"depth_spread_after", result.depth_after},
          {"depth_noise", noise},
          {"halves", HalvesToJson(result.halves)},
          {"halves_spread", result.halves_spread},
          {"displacement_px", result.displacement_px},
          {"passes", result.passes}};
}

}  // namespace rgbd_pose
