#include <cmath>

#include "apps/results/evaluation_report.h"
#include "core/geometry/twist.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

// "1.40 +- 0.05"; "n/a" for what is not determined.
std::string FormatEstimate(double value, double sigma, double factor,
                           int decimals) {
  if (!std::isfinite(sigma)) return "n/a";
  const double unit = std::pow(10.0, -decimals);
  // 0 has no sign.
  const double rounded = unit * std::round(factor * value / unit) + 0.0;
  return FixedNumber(rounded, decimals) + " +- " +
         FixedNumber(factor * sigma, decimals);
}

std::string FormatEstimates(const char* quantity, const Eigen::Vector3d& values,
                            const Eigen::Vector3d& sigmas, double factor,
                            int decimals) {
  std::string text = Format("  %-30s", quantity);
  for (int i = 0; i < 3; ++i) {
    text +=
        Format("  %16s",
               FormatEstimate(values[i], sigmas[i], factor, decimals).c_str());
  }
  return text + "\n";
}

json EstimatesToJson(const Eigen::Vector3d& values, double factor) {
  json result = json::array();
  for (const double value : values) {
    result.push_back(std::isfinite(value) ? json(factor * value) : json());
  }
  return result;
}

Eigen::Vector3d RotationVectorOf(const TruthFixing& fixing) {
  return TwistOf(fixing.camera_from_body, -1.0).angular;
}

}  // namespace

std::string FormatTruthAlignment(const TruthAlignment& alignment,
                                 double rpe_delta_seconds) {
  const std::string head =
      "\nTruth shifted in time and fixed to the camera again";
  if (!alignment.skipped.empty()) {
    return head + ": not estimated; " + alignment.skipped + "\n";
  }
  const TruthFixing& fixing = alignment.fixing;
  std::string text =
      head + Format(", as fits best (%d motions)\n", alignment.motions);
  text +=
      Format("  %-30s  %16s\n", "time shift (ms)",
             FormatEstimate(fixing.shift, alignment.sigma[0], 1e3, 1).c_str());
  text += FormatEstimates("rotation x, y, z (deg)", RotationVectorOf(fixing),
                          alignment.sigma.segment<3>(1), kDegreesPerRadian, 2);
  text +=
      FormatEstimates("lever x, y, z (mm)", fixing.camera_from_body.translation,
                      alignment.sigma.tail<3>(), kMillimetresPerMetre, 1);
  if (!alignment.undetermined.empty()) {
    text += "  not determined by the motion: " + Join(alignment.undetermined) +
            "\n";
  }
  text +=
      Format("%-32s%12s%12s%12s%12s\n", "", "RMSE", "median", "mean", "max");
  text += Format("ATE there (%d poses)\n", alignment.ate.count);
  text += FormatStatistics("position (mm)",
                           Scaled(alignment.ate, kMillimetresPerMetre));
  text += Format("RPE there, fixed delta %g s (%d pairs)\n", rpe_delta_seconds,
                 alignment.rpe_seconds.translation.count);
  text += FormatStatistics(
      "translation (mm)",
      Scaled(alignment.rpe_seconds.translation, kMillimetresPerMetre));
  text += FormatStatistics("rotation (deg)",
                           InDegrees(alignment.rpe_seconds.rotation));
  return text;
}

json TruthAlignmentToJson(const TruthAlignment& alignment,
                          double rpe_delta_seconds) {
  const bool found = alignment.skipped.empty();
  json result = {{"skipped", found ? json() : json(alignment.skipped)},
                 {"motions", alignment.motions},
                 {"undetermined", alignment.undetermined}};
  if (!found) return result;
  const TruthFixing& fixing = alignment.fixing;
  const double shift_sigma = alignment.sigma[0];
  result["time_shift_s"] = fixing.shift;
  result["time_shift_sigma_s"] =
      std::isfinite(shift_sigma) ? json(shift_sigma) : json();
  result["rotation_deg"] =
      EstimatesToJson(RotationVectorOf(fixing), kDegreesPerRadian);
  result["rotation_sigma_deg"] =
      EstimatesToJson(alignment.sigma.segment<3>(1), kDegreesPerRadian);
  result["lever_m"] = EstimatesToJson(fixing.camera_from_body.translation, 1.0);
  result["lever_sigma_m"] = EstimatesToJson(alignment.sigma.tail<3>(), 1.0);
  result["ate"] = {{"count", alignment.ate.count},
                   {"position_m", StatisticsToJson(alignment.ate)}};
  result["rpe_seconds"] = {
      {"delta", rpe_delta_seconds},
      {"count", alignment.rpe_seconds.translation.count},
      {"translation_m", StatisticsToJson(alignment.rpe_seconds.translation)},
      {"rotation_deg",
       StatisticsToJson(InDegrees(alignment.rpe_seconds.rotation))}};
  return result;
}

}  // namespace rgbd_pose
