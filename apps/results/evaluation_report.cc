#include "apps/results/evaluation_report.h"

#include <vector>

#include "core/util/format.h"
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

json PoseToJson(const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace

std::string FormatEvaluation(const EvaluationReport& report) {
  std::string text =
      Format("%d of %d estimated poses have a ground truth within %g s;\n",
             report.paired_poses, report.estimated_poses,
             report.options.max_time_difference);
  text += Format("they span %.3f s and %.3f m of path.\n\n", report.duration,
                 report.path_length);
  text +=
      Format("%-32s%12s%12s%12s%12s\n", "", "RMSE", "median", "mean", "max");
  text +=
      Format("ATE, %s (%d poses)\n", AteDefinition(report), report.ate.count);
  text += FormatStatistics("position (mm)",
                           Scaled(report.ate, kMillimetresPerMetre));
  text += Format("  %-30s%12.4f  at %.5f times the size\n", "  with scale",
                 kMillimetresPerMetre * report.sim3.residual_rmse,
                 report.sim3.truth_per_estimate);
  for (const RelativeEntry& entry : RelativeEntries(report)) {
    text += Format("RPE, %s (%d pairs)\n", entry.definition.c_str(),
                   entry.error.translation.count);
    text += FormatStatistics("translation (mm)", Scaled(entry.error.translation,
                                                        kMillimetresPerMetre));
    text += FormatStatistics("rotation (deg)", InDegrees(entry.error.rotation));
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
    text +=
        Format("RPE, fixed delta %d frame%s (%d pairs)\n", frames,
               frames == 1 ? "" : "s", report.rpe_frames[i].translation.count);
    text += FormatQuantiles(report.rpe_frames[i]);
  }
  text += Format("RPE, fixed delta %g s (%d pairs)\n",
                 report.options.rpe_delta_seconds,
                 report.rpe_seconds.translation.count);
  text += FormatQuantiles(report.rpe_seconds);
  if (report.consistency.has_value()) {
    text += FormatConsistency(*report.consistency);
  }
  return text + FormatTruthAlignment(report.truth_alignment,
                                     report.options.rpe_delta_seconds);
}

json EvaluationToJson(const EvaluationReport& report) {
  json result = {
      {"estimated_poses", report.estimated_poses},
      {"paired_poses", report.paired_poses},
      {"max_time_difference_s", report.options.max_time_difference},
      {"duration_s", report.duration},
      {"path_length_m", report.path_length},
      {"ate",
       {{"definition", AteDefinition(report)},
        {"count", report.ate.count},
        {"position_m", StatisticsToJson(report.ate)}}},
      {"with_scale",
       {{"truth_per_estimate", report.sim3.truth_per_estimate},
        {"position_rmse_m", report.sim3.residual_rmse}}},
      {"truth_from_estimate", PoseToJson(report.truth_from_estimate)},
      {"rpe_frames", json::array()},
      {"truth_alignment",
       TruthAlignmentToJson(report.truth_alignment,
                            report.options.rpe_delta_seconds)},
      {"final_pose", nullptr}};
  for (const RelativeEntry& entry : RelativeEntries(report)) {
    result[entry.key] = {
        {"definition", entry.definition},
        {"delta", entry.delta},
        {"count", entry.error.translation.count},
        {"translation_m", StatisticsToJson(entry.error.translation)},
        {"rotation_deg", StatisticsToJson(InDegrees(entry.error.rotation))}};
  }
  for (size_t i = 0; i < report.rpe_frames.size(); ++i) {
    const RelativePoseError& error = report.rpe_frames[i];
    result["rpe_frames"].push_back(
        {{"frames", report.options.rpe_frames[i]},
         {"count", error.translation.count},
         {"translation_mm",
          StatisticsToJson(Scaled(error.translation, kMillimetresPerMetre))},
         {"rotation_deg", StatisticsToJson(InDegrees(error.rotation))}});
  }
  if (report.consistency.has_value()) {
    result["consistency"] = ConsistencyToJson(*report.consistency);
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
