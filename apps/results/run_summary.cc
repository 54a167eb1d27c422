#include "apps/results/run_summary.h"

#include <algorithm>

#include "core/util/format.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// 0 where there is nothing to sum up.
double QuantileOrZero(const std::vector<double>& values, double share) {
  return values.empty() ? 0.0 : Quantile(values, share);
}

}  // namespace

nlohmann::json Summarise(const std::vector<TrackedFrame>& frames, int threads,
                         double wall_seconds) {
  int status[3] = {}, references = 0, segments = 0, relocalised = 0;
  std::vector<double> matches, inlier_shares;
  for (const TrackedFrame& frame : frames) {
    ++status[static_cast<int>(frame.status)];
    references += frame.is_reference;
    segments = std::max(segments, frame.segment + 1);
    relocalised += frame.relocalised;
    if (frame.matches == 0) continue;
    matches.push_back(frame.matches);
    inlier_shares.push_back(static_cast<double>(frame.inliers) / frame.matches);
  }
  const auto times = [&frames](double TrackedFrame::*ms) {
    std::vector<double> all;
    for (const TrackedFrame& frame : frames) {
      if (frame.*ms > 0.0) all.push_back(frame.*ms);
    }
    return all;
  };
  const auto median_ms = [&times](double TrackedFrame::*ms) {
    return QuantileOrZero(times(ms), 0.5);
  };
  const auto [ok, degraded, lost] = status;
  const auto count = static_cast<double>(frames.size());
  return {
      {"frames", frames.size()},
      {"ok", ok},
      {"degraded", degraded},
      {"lost", lost},
      {"references", references},
      {"segments", segments},
      {"relocalised", relocalised},
      {"tracked_share", frames.empty() ? 0.0 : (ok + degraded) / count},
      {"matches_median", QuantileOrZero(matches, 0.5)},
      {"inlier_share_median", QuantileOrZero(inlier_shares, 0.5)},
      {"decode_ms_median", median_ms(&TrackedFrame::decode_ms)},
      {"track_ms_median", median_ms(&TrackedFrame::track_ms)},
      {"track_ms_p99", QuantileOrZero(times(&TrackedFrame::track_ms), 0.99)},
      {"match_ms_median", median_ms(&TrackedFrame::match_ms)},
      {"solve_ms_median", median_ms(&TrackedFrame::solve_ms)},
      {"reference_ms_median", median_ms(&TrackedFrame::reference_ms)},
      {"relocalise_ms_median", median_ms(&TrackedFrame::relocalise_ms)},
      {"threads", threads},
      {"wall_seconds", wall_seconds},
      {"frames_per_second", wall_seconds > 0.0 ? count / wall_seconds : 0.0}};
}

std::string FormatSummary(const nlohmann::json& summary) {
  const auto number = [&](const char* key) {
    return summary.at(key).get<double>();
  };
  const auto whole = [&](const char* key) {
    return summary.at(key).get<int>();
  };
  return Format(
      "frames      %d, %.1f %% tracked (%d ok, %d degraded, %d lost)%s\n"
      "references  %d, %d segment(s), %d frame(s) found again\n"
      "time        %.2f ms per frame median, %.2f ms 99th percentile, without "
      "decoding\n"
      "            of it %.2f ms matching, %.3f ms pose solve; %.2f ms for a "
      "new reference\n"
      "throughput  %.1f frames/s with decoding (%.2f ms per frame median), %d "
      "thread(s)\n",
      whole("frames"), 100.0 * number("tracked_share"), whole("ok"),
      whole("degraded"), whole("lost"),
      whole("frames") == 1 ? "; one alone has no motion" : "",
      whole("references"), whole("segments"), whole("relocalised"),
      number("track_ms_median"), number("track_ms_p99"),
      number("match_ms_median"), number("solve_ms_median"),
      number("reference_ms_median"), number("frames_per_second"),
      number("decode_ms_median"), whole("threads"));
}

}  // namespace rgbd_pose
