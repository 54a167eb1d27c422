#include "apps/results/run_summary.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/util/format.h"
#include "core/util/quantile.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

double QuantileOrZero(const std::vector<double>& values, double share) {
  return values.empty() ? 0.0 : Quantile(values, share);
}

constexpr size_t kMostJumps = 20;  // reported

// Motions over unequal intervals cannot be compared.
constexpr double kMaxIntervalRatio = 1.6;

// How far the motion to frame i is from its neighbours' mean; -1 if unknown.
double Deviation(const std::vector<TrackedFrame>& frames, size_t i) {
  for (size_t k = i - 2; k <= i + 1; ++k) {
    if (frames[k].status == TrackingStatus::kLost ||
        frames[k].segment != frames[i].segment) {
      return -1.0;
    }
  }
  const auto interval = [&](size_t k) {
    return frames[k].timestamp - frames[k - 1].timestamp;
  };
  const auto [shortest, longest] =
      std::minmax({interval(i - 1), interval(i), interval(i + 1)});
  if (longest > kMaxIntervalRatio * shortest) return -1.0;
  const auto place = [&](size_t k) -> const Eigen::Vector3d& {
    return frames[k].world_from_cam.translation;
  };
  const Eigen::Vector3d neighbours =
      place(i + 1) - place(i) + place(i - 1) - place(i - 2);
  return (place(i) - place(i - 1) - 0.5 * neighbours).norm();
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
  const auto quantile_ms = [&](double TrackedFrame::*ms, double share = 0.5) {
    std::vector<double> times;
    for (const TrackedFrame& frame : frames) {
      if (frame.*ms > 0.0) times.push_back(frame.*ms);
    }
    return QuantileOrZero(times, share);
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
      {"decode_ms_median", quantile_ms(&TrackedFrame::decode_ms)},
      {"track_ms_median", quantile_ms(&TrackedFrame::track_ms)},
      {"track_ms_p99", quantile_ms(&TrackedFrame::track_ms, 0.99)},
      {"match_ms_median", quantile_ms(&TrackedFrame::match_ms)},
      {"solve_ms_median", quantile_ms(&TrackedFrame::solve_ms)},
      {"reference_ms_median", quantile_ms(&TrackedFrame::reference_ms)},
      {"relocalise_ms_median", quantile_ms(&TrackedFrame::relocalise_ms)},
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
      "references  %d, %d segment(s), %d frame(s) relocalised\n"
      "time        %.2f ms per frame median, %.2f ms 99th percentile, without "
      "decoding\n"
      "            of which %.2f ms matching, %.3f ms pose solve; %.2f ms for "
      "a new reference\n"
      "throughput  %.1f frames/s with decoding (%.2f ms per frame median), %d "
      "thread(s)\n",
      whole("frames"), 100.0 * number("tracked_share"), whole("ok"),
      whole("degraded"), whole("lost"),
      whole("frames") == 1 ? "; a single frame has no motion" : "",
      whole("references"), whole("segments"), whole("relocalised"),
      number("track_ms_median"), number("track_ms_p99"),
      number("match_ms_median"), number("solve_ms_median"),
      number("reference_ms_median"), number("frames_per_second"),
      number("decode_ms_median"), whole("threads"));
}

nlohmann::json FindJumps(const std::vector<TrackedFrame>& frames) {
  std::vector<double> deviations;
  std::vector<std::pair<double, size_t>> jumps;  // deviation and frame
  for (size_t i = 2; i + 1 < frames.size(); ++i) {
    const double deviation = Deviation(frames, i);
    if (deviation < 0.0) continue;
    deviations.push_back(deviation);
    // A single wrong motion also affects the difference at its neighbours.
    if (!jumps.empty() && jumps.back().second + 2 >= i) {
      if (jumps.back().first >= 0.99 * deviation) continue;
      jumps.pop_back();
    }
    jumps.emplace_back(deviation, i);
  }
  std::stable_sort(
      jumps.begin(), jumps.end(),
      [](const auto& a, const auto& b) { return a.first > b.first; });
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [deviation, i] : jumps) {
    if (list.size() == kMostJumps ||
        deviation <= std::max(0.01, 6.0 * Median(deviations))) {
      break;
    }
    const TrackedFrame& frame = frames[i];
    list.push_back({{"frame", i},
                    {"seconds", frame.timestamp - frames[0].timestamp},
                    {"translation_m", deviation},
                    {"status", ToString(frame.status)},
                    {"tracking_source", ToString(frame.source)},
                    {"matches", frame.matches},
                    {"inliers", frame.inliers},
                    {"sigma", frame.sigma}});
  }
  return list;
}

std::string FormatJumps(const nlohmann::json& jumps) {
  if (jumps.empty()) return "";
  const nlohmann::json& largest = jumps[0];
  const int frame = largest.at("frame");
  return Format(
      "jumps       %zu%s, the largest at frame %d by %.0f mm (%d of %d %s "
      "agree); --debug_images=%d shows it\n",
      jumps.size(), jumps.size() == kMostJumps ? " or more" : "", frame,
      kMillimetresPerMetre * largest.at("translation_m").get<double>(),
      largest.at("inliers").get<int>(), largest.at("matches").get<int>(),
      largest.at("tracking_source") == "direct" ? "pixels" : "matches", frame);
}

}  // namespace rgbd_pose
