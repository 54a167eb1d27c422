#include "apps/results/evaluation_report.h"
#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

std::string FormatQuantiles(const char* quantity, const ErrorStatistics& e) {
  if (e.count == 0) return Format("  %-30s%12s\n", quantity, "n/a");
  return Format("  %-30s%12.4f%12.4f%12.4f\n", quantity, e.median, e.p90,
                e.p99);
}

std::string FormatLine(const char* what, const Consistency& c) {
  return Format("  %-30s%12d%12d%12.2f%12.2f\n", what, c.count, c.wrong, c.nees,
                c.median);
}

json ToJson(const Consistency& c) {
  return {{"count", c.count},
          {"wrong", c.wrong},
          {"nees", c.count > 0 ? json(c.nees) : json()},
          {"nees_median", c.count > 0 ? json(c.median) : json()}};
}

}  // namespace

ErrorStatistics Scaled(ErrorStatistics errors, double factor) {
  for (double* value : {&errors.rmse, &errors.median, &errors.mean, &errors.max,
                        &errors.p90, &errors.p99}) {
    *value *= factor;
  }
  return errors;
}

std::string FormatStatistics(const char* quantity, const ErrorStatistics& e) {
  if (e.count == 0) return Format("  %-30s%12s\n", quantity, "n/a");
  return Format("  %-30s%12.4f%12.4f%12.4f%12.4f\n", quantity, e.rmse, e.median,
                e.mean, e.max);
}

std::string FormatQuantiles(const RelativePoseError& error) {
  return FormatQuantiles("translation (mm)",
                         Scaled(error.translation, kMillimetresPerMetre)) +
         FormatQuantiles("rotation (deg)", InDegrees(error.rotation));
}

std::string FormatConsistency(const RunConsistency& consistency) {
  const TruthNoise& noise = consistency.truth_noise;
  return Format("\nAgainst covariances (sigma of the truth %g mm, %g deg)\n",
                noise.translation * kMillimetresPerMetre,
                noise.rotation * kDegreesPerRadian) +
         Format("%-32s%12s%12s%12s%12s\n", "", "judged", "wrong", "NEES",
                "median") +
         FormatLine(Format("frames, of %d ok", consistency.ok).c_str(),
                    consistency.ok_frames) +
         FormatLine("all motions", consistency.edges);
}

json StatisticsToJson(const ErrorStatistics& e) {
  if (e.count == 0) return nullptr;
  return {{"rmse", e.rmse}, {"median", e.median}, {"mean", e.mean},
          {"max", e.max},   {"p90", e.p90},       {"p99", e.p99}};
}

json ConsistencyToJson(const RunConsistency& consistency) {
  const TruthNoise& noise = consistency.truth_noise;
  return {{"wrong_above_chi_square", kWrongChiSquare},
          {"truth_sigma_m", noise.translation},
          {"truth_sigma_deg", noise.rotation * kDegreesPerRadian},
          {"ok", consistency.ok},
          {"ok_frames", ToJson(consistency.ok_frames)},
          {"edges", ToJson(consistency.edges)}};
}

}  // namespace rgbd_pose
