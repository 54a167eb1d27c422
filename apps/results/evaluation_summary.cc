#include "apps/results/evaluation_summary.h"

#include "apps/results/evaluation_report.h"
#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

std::string Row(const std::string& quantity, const ErrorStatistics& errors,
                double factor) {
  const std::string text = Format("  %-38s", quantity.c_str());
  if (errors.count == 0) return text + Format("%10s\n", "n/a");
  return text + Format("%10.3f%10.3f%10.3f\n", factor * errors.rmse,
                       factor * errors.median, factor * errors.max);
}

// Three lines with the errors of positions, and of motions over some seconds.
std::string Rows(const ErrorStatistics& ate, const RelativePoseError& rpe,
                 double seconds) {
  const std::string over = Format("RPE over %g s, ", seconds);
  return Row("ATE (mm)", ate, kMillimetresPerMetre) +
         Row(over + "translation (mm)", rpe.translation, kMillimetresPerMetre) +
         Row(over + "rotation (deg)", rpe.rotation, kDegreesPerRadian);
}

}  // namespace

std::string FormatEvaluationSummary(const EvaluationReport& report) {
  const double seconds = report.options.rpe_delta_seconds;
  const std::string head = Format("errors of %d poses, %.3f m of path",
                                  report.paired_poses, report.path_length);
  std::string text =
      Format("%-40s%10s%10s%10s\n", head.c_str(), "RMSE", "median", "max") +
      Rows(report.ate, report.rpe_seconds, seconds);
  const TruthAlignment& alignment = report.truth_alignment;
  if (alignment.skipped.empty()) {
    text += Format(
        "with the truth's clock (%.1f ms) and its body (%.2f deg) corrected:\n",
        1e3 * alignment.fixing.shift,
        kDegreesPerRadian * alignment.fixing.camera_from_body.Angle());
    text += Rows(alignment.ate, alignment.rpe_seconds, seconds);
  }
  if (report.consistency.has_value()) {
    const Consistency& frames = report.consistency->ok_frames;
    text += Format("covariances of ok frames: %d of %d wrong, NEES %.2f (",
                   frames.wrong, frames.count, frames.nees) +
            "ground truth: " + report.consistency->truth_noise.InWords() +
            ")\n";
    const Consistency& in_time = report.consistency->in_time;
    const bool is_by_clock = 10 * frames.wrong > frames.count &&
                             2 * in_time.wrong < frames.wrong &&
                             in_time.count > 0;
    if (is_by_clock) {
      text += Format(
          "  most of them by the truth's clock: with it corrected %d of %d "
          "wrong, NEES %.2f\n",
          in_time.wrong, in_time.count, in_time.nees);
    }
  }
  return text;
}

}  // namespace rgbd_pose
