#include "apps/results/run_summary.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>

#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// 0 where there is nothing to sum up.
double QuantileOrZero(const std::vector<double>& values, double share) {
  return values.empty() ? 0.0 : Quantile(values, share);
}

double MedianOrZero(const std::vector<double>& values) {
  return QuantileOrZero(values, 0.5);
}

}  // namespace

RunSummary Summarise(const std::vector<TrackedFrame>& frames, int threads,
                     double wall_seconds) {
  RunSummary summary;
  summary.threads = threads;
  summary.wall_seconds = wall_seconds;
  std::vector<double> decode, track, match, solve, reference, relocalise,
      matches, inlier_shares;
  const auto add = [](double ms, std::vector<double>* all) {
    if (ms > 0.0) all->push_back(ms);
  };
  for (const TrackedFrame& frame : frames) {
    ++summary.frames;
    summary.ok += frame.status == TrackingStatus::kOk;
    summary.degraded += frame.status == TrackingStatus::kDegraded;
    summary.lost += frame.status == TrackingStatus::kLost;
    summary.references += frame.is_reference;
    decode.push_back(frame.decode_ms);
    track.push_back(frame.track_ms);
    add(frame.match_ms, &match);
    add(frame.solve_ms, &solve);
    add(frame.reference_ms, &reference);
    add(frame.relocalise_ms, &relocalise);
    summary.segments = std::max(summary.segments, frame.segment + 1);
    if (frame.matches > 0) {
      matches.push_back(frame.matches);
      inlier_shares.push_back(static_cast<double>(frame.inliers) /
                              frame.matches);
    }
    summary.relocalised += frame.relocalised;
  }
  summary.median_matches = MedianOrZero(matches);
  summary.median_inlier_share = MedianOrZero(inlier_shares);
  summary.median_decode_ms = MedianOrZero(decode);
  summary.median_track_ms = MedianOrZero(track);
  summary.p99_track_ms = QuantileOrZero(track, 0.99);
  summary.median_match_ms = MedianOrZero(match);
  summary.median_solve_ms = MedianOrZero(solve);
  summary.median_reference_ms = MedianOrZero(reference);
  summary.median_relocalise_ms = MedianOrZero(relocalise);
  return summary;
}

std::string FormatSummary(const RunSummary& summary) {
  char text[1024];
  std::snprintf(
      text, sizeof(text),
      "frames      %d, %.1f %% tracked (%d ok, %d degraded, %d lost)\n"
      "references  %d, %d segment(s), %d frame(s) found again\n"
      "time        %.2f ms per frame median, %.2f ms 99th percentile, without "
      "decoding\n"
      "            of it %.2f ms matching, %.3f ms pose solve; %.2f ms for a "
      "new reference\n"
      "throughput  %.1f frames/s with decoding (%.2f ms per frame median), %d "
      "thread(s)\n",
      summary.frames, 100.0 * summary.TrackedShare(), summary.ok,
      summary.degraded, summary.lost, summary.references, summary.segments,
      summary.relocalised, summary.median_track_ms, summary.p99_track_ms,
      summary.median_match_ms, summary.median_solve_ms,
      summary.median_reference_ms, summary.FramesPerSecond(),
      summary.median_decode_ms, summary.threads);
  return text;
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

double PeakMemoryMb() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024 / 1e6;  // it counts KiB
}

}  // namespace rgbd_pose
