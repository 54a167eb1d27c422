#include "apps/results/calibration_output.h"

#include <cmath>

#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/sources/camera_file_writer.h"

namespace rgbd_pose {
namespace {

using Fate = CalibratedParameter::Fate;

// As many digits as the error bar has meaning.
std::string Value(double value) { return Format("%.6g", value); }

std::string FormatResiduals(const CalibrationResult& result) {
  std::string text = "u,v,before_u,before_v,after_u,after_v\n";
  for (const HeldOutResidual& r : result.residuals) {
    text += Format("%.2f,%.2f,%.4f,%.4f,%.4f,%.4f\n", r.u, r.v, r.before.x(),
                   r.before.y(), r.after.x(), r.after.y());
  }
  return text;
}

}  // namespace

const char* ToString(Fate fate) {
  switch (fate) {
    case Fate::kFixed:
      return "fixed";
    case Fate::kUndetermined:
      return "not determined";
    case Fate::kDetermined:
      return "determined";
  }
  return "";
}

std::string FormatCalibrationSummary(const CalibrationResult& result) {
  std::string text =
      Format("%d keyframes, %d pairs, %d landmarks in %d views\n",
             result.keyframes, result.pairs, result.landmarks, result.views);
  text += Format("%-22s %12s %12s %10s  %s\n", "", "before", "found", "+-", "");
  std::string undetermined;
  for (int k = 0; k < kCalibrationSize; ++k) {
    const CalibrationParameter& row = kCalibrationParameters[k];
    const CalibratedParameter& parameter = result.parameters[k];
    if (parameter.fate == Fate::kFixed) continue;
    if (parameter.fate == Fate::kUndetermined) {
      undetermined += std::string(undetermined.empty() ? "" : ", ") + row.name;
      continue;
    }
    text +=
        Format("%-22s %12s %12s %10s  %s\n", row.name,
               Value(parameter.before).c_str(), Value(parameter.found).c_str(),
               Format("%.2g", parameter.sigma).c_str(), row.unit);
  }
  if (!undetermined.empty()) {
    text += "the recording does not determine " + undetermined +
            ": they stay as they are\n";
  }
  if (result.scale_from.empty()) {
    text +=
        "nothing gives depth a scale (images alone cannot): depth_factor is "
        "left alone\n";
  } else {
    text += "depth has its scale from " + result.scale_from + "\n";
  }
  if (result.held_out_pairs > 0) {
    text += Format(
        "%d pairs held out: cost of a view %.4g -> %.4g (%.1f standard "
        "deviations); pixels spread by %.3g -> %.3g px\n",
        result.held_out_pairs, result.cost_before, result.cost_after,
        result.gain_sigmas, 0.5 * result.pixel_before,
        0.5 * result.pixel_after);
  }
  text += result.is_accepted
              ? "the new camera is better: take camera.yaml\n"
              : "the first camera is kept: " + result.reason + "\n";
  return text;
}

nlohmann::json CalibrationToJson(const CalibrationResult& result) {
  nlohmann::json parameters = nlohmann::json::array();
  for (int k = 0; k < kCalibrationSize; ++k) {
    const CalibrationParameter& row = kCalibrationParameters[k];
    const CalibratedParameter& parameter = result.parameters[k];
    parameters.push_back({{"name", row.name},
                          {"what", row.what},
                          {"unit", row.unit},
                          {"fate", ToString(parameter.fate)},
                          {"before", parameter.before},
                          {"prior_sigma", parameter.prior},
                          {"found", parameter.found},
                          {"sigma", parameter.sigma}});
  }
  return {{"accepted", result.is_accepted},
          {"reason", result.reason},
          {"parameters", parameters},
          {"scale_from", result.scale_from},
          {"keyframes", result.keyframes},
          {"pairs", result.pairs},
          {"held_out_pairs", result.held_out_pairs},
          {"landmarks", result.landmarks},
          {"views", result.views},
          {"cost_before", result.cost_before},
          {"cost_after", result.cost_after},
          {"gain_sigmas", result.gain_sigmas},
          {"truth_error_before", result.truth_before},
          {"truth_error_after", result.truth_after},
          {"pixel_spread_before", result.pixel_before},
          {"pixel_spread_after", result.pixel_after},
          {"depth_spread_before", result.depth_before},
          {"depth_spread_after", result.depth_after}};
}

void CalibrationOutput::WriteFile(const char* name,
                                  const std::string& content) const {
  WriteFileAtomically((folder_.aside() / name).string(), content);
}

void CalibrationOutput::Write(const CalibrationResult& result,
                              const std::string& camera,
                              const std::string& flags, double seconds) {
  WriteFile("camera.yaml", FormatCameraFile(result.camera, camera));
  WriteFile("residuals.csv", FormatResiduals(result));
  WriteFile("config.flags", flags);
  nlohmann::json metrics = {{"program", "rgbd_calibrate"},
                            {"seconds", seconds},
                            {"calibration", CalibrationToJson(result)}};
  WriteFile("metrics.json", metrics.dump(2) + "\n");
}

}  // namespace rgbd_pose
