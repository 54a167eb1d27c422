#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/estimation/motion_estimate.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// What a run comes to.
struct RunSummary {
  int frames = 0;
  int ok = 0;
  int degraded = 0;
  int lost = 0;
  int references = 0;
  int segments = 0;
  int relocalised = 0;
  // Of the frames that were matched against a reference.
  double median_matches = 0.0;
  double median_inlier_share = 0.0;
  double median_decode_ms = 0.0;
  double median_track_ms = 0.0;
  double p99_track_ms = 0.0;
  // Of the frames in which they took place.
  double median_match_ms = 0.0;
  double median_solve_ms = 0.0;
  double median_reference_ms = 0.0;
  double median_relocalise_ms = 0.0;

  // Of the whole program, up to the last frame.
  int threads = 0;
  double wall_seconds = 0.0;

  // Share of frames with a pose, 0 to 1.
  double TrackedShare() const {
    return frames > 0 ? static_cast<double>(ok + degraded) / frames : 0.0;
  }
  double FramesPerSecond() const {
    return wall_seconds > 0.0 ? frames / wall_seconds : 0.0;
  }
};

RunSummary Summarise(const std::vector<TrackedFrame>& frames, int threads,
                     double wall_seconds);

// How the whitened residuals and the robust weights of a run's matches are
// spread, over all frames.
struct ResidualHistogram {
  // Bins of norms (sigmas) and of weights; the last bin of weights holds 1.
  static constexpr double kNormBin = 0.1;
  static constexpr double kWeightBin = 0.05;

  int64_t matches = 0;  // that some cost could use
  std::array<int64_t, 80> norms = {};
  int64_t norms_above = 0;  // the last bin
  std::array<int64_t, 20> weights = {};
  int64_t weights_zero = 0;             // exactly
  std::array<int64_t, 7> degrees = {};  // matches of 0 to 6 measurements

  // Adds the matches of one frame.
  void Add(const MotionEstimate& estimate);
};

}  // namespace rgbd_pose
