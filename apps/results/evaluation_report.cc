#include "apps/results/evaluation_report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/geometry/twist.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

const char* AteDefinition(const EvaluationReport& report) {
  return report.options.align ? "rigid alignment, no scale" : "no alignment";
}

constexpr char kFinalPoseDefinition[] = "last pose relative to the first";

struct RelativeEntry {
  std::string key;
  std::string definition;
  double delta;
  const RelativePoseError& error;
};

std::vector<RelativeEntry> RelativeEntries(const EvaluationReport& report) {
  const double seconds = report.options.rpe_delta_seconds;
  const double metres = report.options.rpe_delta_metres;
  return {
      {"rpe_frame", "fixed delta 1 frame, consecutive poses", 1.0,
       report.rpe_frame},
      {"rpe_seconds", Format("fixed delta %g s", seconds), seconds,
       report.rpe_seconds},
      {"rpe_metres", Format("fixed delta %g m of ground-truth path", metres),
       metres, report.rpe_metres}};
}

// Infinite values are null in the file.
json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json ToJson(const Rigid3d& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"translation_m", ToJson(pose.translation)},
          {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

using Columns = std::vector<double ErrorStatistics::*>;
const Columns kOverall = {&ErrorStatistics::rmse, &ErrorStatistics::median,
                          &ErrorStatistics::mean, &ErrorStatistics::max};
const Columns kQuantiles = {&ErrorStatistics::median, &ErrorStatistics::p90,
                            &ErrorStatistics::p99};

// One line of the table: a quantity, times `factor`, in its unit.
std::string FormatStatistics(const char* quantity,
                             const ErrorStatistics& errors, double factor,
                             const Columns& columns) {
  std::string text = Format("  %-30s", quantity);
  if (errors.count == 0) return text + Format("%12s\n", "n/a");
  for (const auto column : columns) {
    text += Format("%12.4f", errors.*column * factor);
  }
  return text + "\n";
}

std::string FormatAte(const std::string& title, const ErrorStatistics& ate) {
  return Format("%-32s%12s%12s%12s%12s\n", "", "RMSE", "median", "mean",
                "max") +
         Format("ATE%s (%d poses)\n", title.c_str(), ate.count) +
         FormatStatistics("position (mm)", ate, kMillimetresPerMetre, kOverall);
}

std::string FormatRpe(const std::string& title, const RelativePoseError& error,
                      const Columns& columns = kOverall) {
  return Format("RPE%s (%d pairs)\n", title.c_str(), error.translation.count) +
         FormatStatistics("translation (mm)", error.translation,
                          kMillimetresPerMetre, columns) +
         FormatStatistics("rotation (deg)", error.rotation, kDegreesPerRadian,
                          columns);
}

json StatisticsToJson(const ErrorStatistics& e, double factor = 1.0) {
  if (e.count == 0) return nullptr;
  return {{"rmse", factor * e.rmse}, {"median", factor * e.median},
          {"mean", factor * e.mean}, {"max", factor * e.max},
          {"p90", factor * e.p90},   {"p99", factor * e.p99}};
}

json AteToJson(const ErrorStatistics& ate) {
  return {{"count", ate.count}, {"position_m", StatisticsToJson(ate)}};
}

json RpeToJson(const RelativePoseError& error, double delta) {
  return {
      {"delta", delta},
      {"count", error.translation.count},
      {"translation_m", StatisticsToJson(error.translation)},
      {"rotation_deg", StatisticsToJson(error.rotation, kDegreesPerRadian)}};
}

std::string FormatConsistency(const RunConsistency& consistency) {
  const auto line = [](const std::string& what, const Consistency& c) {
    return Format("  %-30s%12d%12d%12.2f%12.2f\n", what.c_str(), c.count,
                  c.wrong, c.nees, c.median);
  };
  return "\nErrors and covariances (ground truth: " +
         consistency.truth_noise.InWords() + ")\n" +
         Format("%-32s%12s%12s%12s%12s\n", "", "evaluated", "wrong", "NEES",
                "median") +
         line(Format("frames, of %d ok", consistency.ok),
              consistency.ok_frames) +
         line("all motions", consistency.edges);
}

json ToJson(const Consistency& c) {
  return {{"count", c.count},
          {"wrong", c.wrong},
          {"nees", c.count > 0 ? json(c.nees) : json()},
          {"nees_median", c.count > 0 ? json(c.median) : json()}};
}

// Formats values such as "1.40 +- 0.05", or "n/a" if undetermined.
std::string FormatEstimates(const char* quantity, const Eigen::VectorXd& values,
                            const Eigen::VectorXd& sigmas, double factor,
                            int decimals) {
  const double unit = std::pow(10.0, -decimals);
  std::string text = Format("  %-30s", quantity);
  for (int i = 0; i < values.size(); ++i) {
    // Adding 0.0 removes the sign of -0.
    const double rounded = unit * std::round(factor * values[i] / unit) + 0.0;
    const std::string estimate =
        Format("%.*f +- %.*f", decimals, rounded, decimals, factor * sigmas[i]);
    text +=
        Format("  %16s", std::isfinite(sigmas[i]) ? estimate.c_str() : "n/a");
  }
  return text + "\n";
}

Eigen::Vector3d RotationVectorOf(const TruthFixing& fixing) {
  return TwistOf(fixing.camera_from_body, -1.0).angular;
}

std::string FormatTruthAlignment(const EvaluationReport& report) {
  const TruthAlignment& alignment = report.truth_alignment;
  const std::string head =
      "\nBest time shift of the ground truth and its body in the camera";
  if (!alignment.skipped.empty()) {
    return head + ": not estimated; " + alignment.skipped + "\n";
  }
  const TruthFixing& fixing = alignment.fixing;
  std::string text = head + Format(" (%d motions)\n", alignment.motions);
  text += FormatEstimates("time shift (ms)",
                          Eigen::VectorXd::Constant(1, fixing.shift),
                          alignment.sigma.head<1>(), 1e3, 1);
  text += FormatEstimates("rotation x, y, z (deg)", RotationVectorOf(fixing),
                          alignment.sigma.segment<3>(1), kDegreesPerRadian, 2);
  text +=
      FormatEstimates("lever x, y, z (mm)", fixing.camera_from_body.translation,
                      alignment.sigma.tail<3>(), kMillimetresPerMetre, 1);
  if (!alignment.undetermined.empty()) {
    text += "  not determined by the motion: " + Join(alignment.undetermined) +
            "\n";
  }
  return text + FormatAte(", after this correction", alignment.ate) +
         FormatRpe(Format(", after this correction, fixed delta %g s",
                          report.options.rpe_delta_seconds),
                   alignment.rpe_seconds);
}

json TruthAlignmentToJson(const EvaluationReport& report) {
  const TruthAlignment& alignment = report.truth_alignment;
  const bool found = alignment.skipped.empty();
  json result = {{"skipped", found ? json() : json(alignment.skipped)},
                 {"motions", alignment.motions},
                 {"undetermined", alignment.undetermined}};
  if (!found) return result;
  const TruthFixing& fixing = alignment.fixing;
  result["time_shift_s"] = fixing.shift;
  result["time_shift_sigma_s"] = alignment.sigma[0];
  result["rotation_deg"] = ToJson(kDegreesPerRadian * RotationVectorOf(fixing));
  result["rotation_sigma_deg"] =
      ToJson(kDegreesPerRadian * alignment.sigma.segment<3>(1));
  result["lever_m"] = ToJson(fixing.camera_from_body.translation);
  result["lever_sigma_m"] = ToJson(alignment.sigma.tail<3>());
  result["ate"] = AteToJson(alignment.ate);
  result["rpe_seconds"] =
      RpeToJson(alignment.rpe_seconds, report.options.rpe_delta_seconds);
  return result;
}

}  // namespace

std::string FormatEvaluation(const EvaluationReport& report) {
  std::string text =
      Format("%d of %d estimated poses have a ground truth within %g s;\n",
             report.paired_poses, report.estimated_poses,
             report.options.max_time_difference);
  text += Format("they span %.3f s and %.3f m of path.\n\n", report.duration,
                 report.path_length);
  text += FormatAte(Format(", %s", AteDefinition(report)), report.ate);
  text += Format("  %-30s%12.4f  if scaled by %.5f\n", "  with scale",
                 kMillimetresPerMetre * report.sim3.residual_rmse,
                 report.sim3.truth_per_estimate);
  for (const RelativeEntry& entry : RelativeEntries(report)) {
    text += FormatRpe(", " + entry.definition, entry.error);
  }
  text += Format("Final pose error, %s\n", kFinalPoseDefinition);
  if (report.final_pose.has_value()) {
    text += Format("  %-30s%12.4f\n", "translation (mm)",
                   kMillimetresPerMetre * report.final_pose->translation);
    text += Format("  %-30s%12.4f\n", "rotation (deg)",
                   report.final_pose->angle * kDegreesPerRadian);
  } else {
    text += Format("  %-30s%12s\n", "", "n/a");
  }
  text += Format("\n%-32s%12s%12s%12s\n", "", "median", "90 %", "99 %");
  for (size_t i = 0; i < report.rpe_frames.size(); ++i) {
    const int frames = report.options.rpe_frames[i];
    text += FormatRpe(
        Format(", fixed delta %d frame%s", frames, frames == 1 ? "" : "s"),
        report.rpe_frames[i], kQuantiles);
  }
  text +=
      FormatRpe(Format(", fixed delta %g s", report.options.rpe_delta_seconds),
                report.rpe_seconds, kQuantiles);
  if (report.consistency.has_value()) {
    text += FormatConsistency(*report.consistency);
  }
  return text + FormatTruthAlignment(report);
}

json EvaluationToJson(const EvaluationReport& report) {
  json result = {{"estimated_poses", report.estimated_poses},
                 {"paired_poses", report.paired_poses},
                 {"max_time_difference_s", report.options.max_time_difference},
                 {"duration_s", report.duration},
                 {"path_length_m", report.path_length},
                 {"ate", AteToJson(report.ate)},
                 {"with_scale",
                  {{"truth_per_estimate", report.sim3.truth_per_estimate},
                   {"position_rmse_m", report.sim3.residual_rmse}}},
                 {"truth_from_estimate", ToJson(report.truth_from_estimate)},
                 {"rpe_frames", json::array()},
                 {"truth_alignment", TruthAlignmentToJson(report)},
                 {"final_pose", nullptr}};
  result["ate"]["definition"] = AteDefinition(report);
  for (const RelativeEntry& entry : RelativeEntries(report)) {
    result[entry.key] = RpeToJson(entry.error, entry.delta);
    result[entry.key]["definition"] = entry.definition;
  }
  for (size_t i = 0; i < report.rpe_frames.size(); ++i) {
    const RelativePoseError& error = report.rpe_frames[i];
    result["rpe_frames"].push_back(
        {{"frames", report.options.rpe_frames[i]},
         {"count", error.translation.count},
         {"translation_mm",
          StatisticsToJson(error.translation, kMillimetresPerMetre)},
         {"rotation_deg",
          StatisticsToJson(error.rotation, kDegreesPerRadian)}});
  }
  if (report.consistency.has_value()) {
    const TruthNoise& noise = report.consistency->truth_noise;
    result["consistency"] = {
        {"wrong_above_chi_square", kWrongChiSquare},
        {"truth_sigma_m", noise.translation},
        {"truth_sigma_deg", noise.rotation * kDegreesPerRadian},
        {"truth_sigma_origin", noise.origin},
        {"ok", report.consistency->ok},
        {"ok_frames", ToJson(report.consistency->ok_frames)},
        {"edges", ToJson(report.consistency->edges)},
        {"ok_frames_in_time", ToJson(report.consistency->in_time)}};
  }
  if (report.final_pose) {
    result["final_pose"] = {
        {"definition", kFinalPoseDefinition},
        {"translation_m", report.final_pose->translation},
        {"rotation_deg", report.final_pose->angle * kDegreesPerRadian}};
  }
  return result;
}

}  // namespace rgbd_pose
