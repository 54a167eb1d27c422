#include "apps/pipeline/run_summary.h"

#include <algorithm>

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

void ResidualHistogram::Add(const MotionEstimate& estimate) {
  for (size_t i = 0; i < estimate.residual_norms.size(); ++i) {
    const int count = estimate.residual_degrees[i];
    if (count == 0) continue;
    ++matches;
    ++degrees[std::min<size_t>(count, degrees.size() - 1)];
    // Compared as numbers: a huge norm does not fit into a place.
    const double place = estimate.residual_norms[i] / kNormBin;
    if (place < norms.size()) {
      ++norms[static_cast<size_t>(place)];
    } else {
      ++norms_above;
    }
    const double weight = estimate.weights[i];
    weights_zero += weight == 0.0;
    ++weights[std::min(static_cast<size_t>(weight / kWeightBin),
                       weights.size() - 1)];
  }
}

}  // namespace rgbd_pose
