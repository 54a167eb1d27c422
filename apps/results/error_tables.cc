#include "apps/results/error_tables.h"

#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

std::string FormatQuantiles(const char* quantity, const ErrorQuantiles& e,
                            double factor) {
  if (e.count == 0) return Format("  %-30s%12s\n", quantity, "n/a");
  return Format("  %-30s%12.4f%12.4f%12.4f\n", quantity, factor * e.median,
                factor * e.p90, factor * e.p99);
}

json QuantilesToJson(const ErrorQuantiles& e, double factor) {
  if (e.count == 0) return nullptr;
  return {{"median", factor * e.median},
          {"p90", factor * e.p90},
          {"p99", factor * e.p99}};
}

}  // namespace

ErrorStatistics InDegrees(const ErrorStatistics& radians) {
  ErrorStatistics degrees = radians;
  for (double* value :
       {&degrees.rmse, &degrees.median, &degrees.mean, &degrees.max}) {
    *value *= kDegreesPerRadian;
  }
  return degrees;
}

std::string FormatStatistics(const char* quantity, const ErrorStatistics& e) {
  if (e.count == 0) return Format("  %-30s%12s\n", quantity, "n/a");
  return Format("  %-30s%12.5f%12.5f%12.5f%12.5f\n", quantity, e.rmse, e.median,
                e.mean, e.max);
}

std::string FormatFrameErrors(const std::vector<FramePoseError>& errors) {
  if (errors.empty()) return "";
  std::string text =
      Format("\n%-32s%12s%12s%12s\n", "", "median", "90 %", "99 %");
  for (const FramePoseError& error : errors) {
    text += Format("RPE, fixed delta %d frame%s (%d pairs)\n", error.frames,
                   error.frames == 1 ? "" : "s", error.translation.count);
    text += FormatQuantiles("translation (mm)", error.translation,
                            kMillimetresPerMetre);
    text +=
        FormatQuantiles("rotation (deg)", error.rotation, kDegreesPerRadian);
  }
  return text;
}

json StatisticsToJson(const ErrorStatistics& e) {
  if (e.count == 0) return nullptr;
  return {
      {"rmse", e.rmse}, {"median", e.median}, {"mean", e.mean}, {"max", e.max}};
}

json FrameErrorsToJson(const std::vector<FramePoseError>& errors) {
  json result = json::array();
  for (const FramePoseError& error : errors) {
    result.push_back(
        {{"frames", error.frames},
         {"count", error.translation.count},
         {"translation_mm",
          QuantilesToJson(error.translation, kMillimetresPerMetre)},
         {"rotation_deg", QuantilesToJson(error.rotation, kDegreesPerRadian)}});
  }
  return result;
}

}  // namespace rgbd_pose
