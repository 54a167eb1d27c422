#include "apps/results/run_metrics.h"

#include <sys/resource.h>

#include "core/util/format.h"

namespace rgbd_pose {

std::string FormatSummary(const RunSummary& summary) {
  const char* const alone =
      summary.frames == 1 ? "; one alone has no motion" : "";
  return Format(
      "frames      %d, %.1f %% tracked (%d ok, %d degraded, %d lost)%s\n"
      "references  %d, %d segment(s), %d frame(s) found again\n"
      "time        %.2f ms per frame median, %.2f ms 99th percentile, without "
      "decoding\n"
      "            of it %.2f ms matching, %.3f ms pose solve; %.2f ms for a "
      "new reference\n"
      "throughput  %.1f frames/s with decoding (%.2f ms per frame median), %d "
      "thread(s)\n",
      summary.frames, 100.0 * summary.TrackedShare(), summary.ok,
      summary.degraded, summary.lost, alone, summary.references,
      summary.segments, summary.relocalised, summary.median_track_ms,
      summary.p99_track_ms, summary.median_match_ms, summary.median_solve_ms,
      summary.median_reference_ms, summary.FramesPerSecond(),
      summary.median_decode_ms, summary.threads);
}

nlohmann::json SummaryToJson(const RunSummary& summary) {
  return {{"frames", summary.frames},
          {"ok", summary.ok},
          {"degraded", summary.degraded},
          {"lost", summary.lost},
          {"references", summary.references},
          {"segments", summary.segments},
          {"relocalised", summary.relocalised},
          {"tracked_share", summary.TrackedShare()},
          {"matches_median", summary.median_matches},
          {"inlier_share_median", summary.median_inlier_share},
          {"decode_ms_median", summary.median_decode_ms},
          {"track_ms_median", summary.median_track_ms},
          {"track_ms_p99", summary.p99_track_ms},
          {"match_ms_median", summary.median_match_ms},
          {"solve_ms_median", summary.median_solve_ms},
          {"reference_ms_median", summary.median_reference_ms},
          {"relocalise_ms_median", summary.median_relocalise_ms},
          {"threads", summary.threads},
          {"wall_seconds", summary.wall_seconds},
          {"frames_per_second", summary.FramesPerSecond()}};
}

nlohmann::json ResidualsToJson(const ResidualHistogram& residuals) {
  return {{"matches", residuals.matches},
          {"norm_bin", residuals.kNormBin},
          {"norm_counts", residuals.norms},
          {"norms_above", residuals.norms_above},
          {"weight_bin", residuals.kWeightBin},
          {"weight_counts", residuals.weights},
          {"weights_zero", residuals.weights_zero},
          {"degrees_counts", residuals.degrees}};
}

double PeakMemoryMb() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024 / 1e6;  // it counts KiB
}

}  // namespace rgbd_pose
