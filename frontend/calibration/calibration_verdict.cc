#include "frontend/calibration/calibration_verdict.h"

#include <algorithm>
#include <cmath>

#include "core/util/format.h"
#include "frontend/calibration/calibration_passes.h"

namespace rgbd_pose {
namespace {

// Whether every pixel of the image border has a ray. Coefficients that fit
// where the features are may make the lens model fold over towards the corners.
bool HasRaysAllAround(const Camera& camera) {
  const auto has_ray = [&](double u, double v) {
    return camera.Undistort({u, v}).allFinite();
  };
  for (int u = 0; u < camera.width; ++u) {
    if (!has_ray(u, 0.0) || !has_ray(u, camera.height - 1.0)) return false;
  }
  for (int v = 0; v < camera.height; ++v) {
    if (!has_ray(0.0, v) || !has_ray(camera.width - 1.0, v)) return false;
  }
  return true;
}

// Whether the principal point is near the centre, as that of images that were
// not cropped.
bool IsCentred(const Camera& camera) {
  constexpr double kMaxOffCentre = 0.1;  // share of the size
  return std::abs(camera.cx - 0.5 * (camera.width - 1)) <=
             kMaxOffCentre * camera.width &&
         std::abs(camera.cy - 0.5 * (camera.height - 1)) <=
             kMaxOffCentre * camera.height;
}

// The parameter whose halves differ most; null if the halves were not compared.
const HalvesOfParameter* WorstOfHalves(const CalibrationResult& result) {
  const auto worst = std::max_element(
      result.halves.begin(), result.halves.end(),
      [](const HalvesOfParameter& a, const HalvesOfParameter& b) {
        return a.Sigmas() < b.Sigmas();
      });
  return worst == result.halves.end() ? nullptr : &*worst;
}

}  // namespace

std::string WhatIsLeft(const CalibrationResult& result) {
  constexpr double kOfFeatures = 0.3;  // px, with rendered recordings
  const double px = 0.5 * result.pixel_after;
  return Format("residuals spread by %.3g px, %s the %.3g px of feature noise",
                px, px > 1.5 * kOfFeatures ? "more than" : "consistent with",
                kOfFeatures);
}

std::string WhyUnchecked(const CalibrationSettings& settings,
                         const CalibrationResult& result) {
  const HalvesOfParameter* worst = WorstOfHalves(result);
  if (worst == nullptr) return HalvesInWords(result);
  if (worst->Sigmas() <= settings.max_halves_sigmas) return "";
  const CalibrationParameter& row = kCalibrationParameters[worst->part];
  const std::string disagree = Format(
      "the halves of the recording disagree: %s differs by %.3g%s%s (%.3g "
      "standard deviations)",
      row.name, std::abs(worst->second - worst->first),
      row.unit[0] == '\0' ? "" : " ", row.unit, worst->Sigmas());
  if (result.passes == 1 && IsAnotherPassDue(result)) {
    return disagree + Format(
                          ", as images were displaced by %.1f px; another pass "
                          "is needed",
                          result.displacement_px);
  }
  return disagree + ", so there is an error that no parameter describes (" +
         WhatIsLeft(result) + ")";
}

std::string HalvesInWords(const CalibrationResult& result) {
  const HalvesOfParameter* worst = WorstOfHalves(result);
  if (worst == nullptr) {
    return "the halves of the recording have too little data to be compared";
  }
  std::string text = Format(
      "the halves of the recording, calibrated separately, differ by at most "
      "%.3g standard deviations",
      worst->Sigmas());
  if (result.halves_spread > 1.0) {
    text += Format(" after error bars were widened by a factor of %.3g",
                   result.halves_spread);
  }
  return text;
}

std::string UnseenInWords(const CalibrationResult& result) {
  if (result.unseen_before == 0.0) return "a half could not be solved";
  return Format(
      "each half with the camera found in the other half: cost per view %.4g "
      "-> %.4g (%.1f standard errors)",
      result.unseen_before, result.unseen_after, result.unseen_sigmas);
}

std::string ImplausibilityReason(const RgbdCamera& first,
                                 const CalibrationResult& result) {
  constexpr double kMaxAspect = 0.01;  // difference of fx and fy, as a share
  constexpr double kMaxPriorSigmas = 4.0;  // of any parameter
  const auto implausible = [](const std::string& why) {
    return "the camera found is not plausible: " + why;
  };
  const Camera& camera = result.found.camera;
  const double aspect = camera.fx / camera.fy;
  const double aspect_before = first.camera.fx / first.camera.fy;
  if (std::abs(aspect - 1.0) > kMaxAspect &&
      std::abs(aspect / aspect_before - 1.0) > kMaxAspect) {
    return implausible(
        Format("fx and fy differ by %.3g %%", 100.0 * std::abs(aspect - 1.0)));
  }
  if (IsCentred(first.camera) && !IsCentred(camera)) {
    return implausible(Format(
        "its principal point (%.3g, %.3g) is too far from the image centre",
        camera.cx, camera.cy));
  }
  if (HasRaysAllAround(first.camera) && !HasRaysAllAround(camera)) {
    return implausible(
        "its distortion is not invertible at the image border; record objects "
        "there, too");
  }
  for (int k = 0; k < kCalibrationSize; ++k) {
    const CalibratedParameter& parameter = result.parameters[k];
    if (parameter.status != CalibratedParameter::Status::kDetermined) continue;
    const double moved =
        std::abs(parameter.found - parameter.before) / parameter.prior;
    if (moved > kMaxPriorSigmas) {
      return implausible(
          Format("%s changes by %.3g standard deviations of its prior",
                 kCalibrationParameters[k].name, moved));
    }
  }
  return "";
}

std::string WhyNoBetter(const RgbdCamera& first,
                        const CalibrationSettings& settings,
                        const CalibrationResult& result) {
  if (result.held_out_pairs < 2) {
    return "there are too few held-out pairs to evaluate the new camera";
  }
  if (result.cost_after > result.cost_of_map) {
    return Format(
        "the solution fails: held-out pairs fit worse (cost %.3g) than with "
        "the poses of the map (%.3g), so some matches are wrong",
        result.cost_after, result.cost_of_map);
  }
  const double gain = 1.0 - result.cost_after / result.cost_before;
  if (!(gain >= settings.min_gain) || !(result.gain_sigmas >= kMinSigmas)) {
    return Format(
        "held-out pairs fit no better with the camera found: their cost %s by "
        "%.3g %% (%.3g standard deviations)",
        gain < 0.0 ? "rises" : "falls", 100.0 * std::abs(gain),
        std::abs(result.gain_sigmas));
  }
  if (!(result.unseen_sigmas >= kMinSigmas)) {
    return "it fits no better what it has not seen: " + UnseenInWords(result);
  }
  if (result.truth_after > result.truth_before) {
    return Format(
        "the ground truth contradicts it: motions of pairs are wrong by %.3g "
        "mm instead of %.3g mm",
        1e3 * result.truth_after, 1e3 * result.truth_before);
  }
  const bool has_moved = std::any_of(
      result.parameters.begin(), result.parameters.end(),
      [](const CalibratedParameter& p) {
        return p.status == CalibratedParameter::Status::kDetermined &&
               std::abs(p.found - p.before) > kMinSigmas * p.sigma;
      });
  if (!has_moved) {
    return Format(
        "no error found: no determined parameter changes by more than %.3g "
        "standard deviations",
        kMinSigmas);
  }
  return ImplausibilityReason(first, result);
}

}  // namespace rgbd_pose
