#include "frontend/calibration/calibration_passes.h"

#include <string>

#include "frontend/calibration/calibration_verdict.h"

namespace rgbd_pose {
namespace {

using Status = CalibratedParameter::Status;

// The parameters of all passes if the last one found a better camera.
CalibrationResult WithStep(const RgbdCamera& first,
                           const CalibrationResult& further,
                           CalibrationResult all) {
  const CalibrationVector values = CameraValues(first, further.found);
  for (int k = 0; k < kCalibrationSize; ++k) {
    CalibratedParameter& parameter = all.parameters[k];
    if (further.parameters[k].status == Status::kDetermined) {
      parameter.status = Status::kDetermined;
      parameter.sigma = further.parameters[k].sigma;
    }
    if (parameter.status == Status::kDetermined) parameter.found = values[k];
  }
  all.found = further.found;
  all.noise_found = further.noise_found;
  all.pixel_after = further.pixel_after;
  all.depth_after = further.depth_after;
  all.truth_after = further.truth_after;
  return all;
}

}  // namespace

bool IsAnotherPassDue(const CalibrationResult& result) {
  return result.is_better && result.displacement_px > 1.0;
}

void TakeUp(const RgbdCamera& first, const CalibrationSettings& settings,
            const CalibrationResult& further, CalibrationResult* all) {
  ++all->passes;
  // The error bars of earlier passes are as wide as the last halves require.
  for (CalibratedParameter& parameter : all->parameters) {
    parameter.sigma *= further.halves_spread / all->halves_spread;
  }
  all->halves = further.halves;
  all->halves_spread = further.halves_spread;
  if (further.is_better) {
    const CalibrationResult merged = WithStep(first, further, *all);
    if (ImplausibilityReason(first, merged).empty()) *all = merged;
  }
  all->Conclude(first, WhyUnchecked(settings, *all));
}

}  // namespace rgbd_pose
