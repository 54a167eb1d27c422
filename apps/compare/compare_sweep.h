#pragma once

#include <string>
#include <vector>

#include "apps/compare/compare_statistics.h"
#include "apps/pipeline/settings.h"

namespace rgbd_pose {

struct SweepOptions {
  std::vector<std::string> losses;
  EstimatorSettings estimator;  // without loss and schedule
  int seeds = 200;              // random motions with their matches, per share
  int matches = 300;            // right and wrong ones
  int threads = 1;              // the result does not depend on it
};

// A way to get from matches to a motion: the loss and how it is helped.
struct SweepMethod {
  std::string loss;
  std::string schedule;  // gnc or direct
  bool ransac = false;   // the solver starts from RANSAC, else from no motion
};

// The errors of a method at a share of wrong matches.
struct SweepCell {
  SweepMethod method;
  double outlier_share = 0.0;
  MedianBand rotation_deg;
  MedianBand translation_mm;
};

// The shares of wrong matches: 0, 10, ... 60 %.
constexpr int kSweepShares = 7;
inline double SweepShare(int i) { return i * 0.1; }

// Estimates the motions of simulated matches, some wrong, with every loss,
// schedule and start; all methods see the same matches. Ordered by loss,
// schedule, start, share. Throws InputError for unknown names.
std::vector<SweepCell> RunSweep(const SweepOptions& options);

// The cells of one method, by share; nothing if it did not run.
std::vector<SweepCell> CellsOf(const std::vector<SweepCell>& cells,
                               const SweepMethod& method);

// The losses of a sweep in its order.
std::vector<std::string> LossesOf(const std::vector<SweepCell>& cells);

}  // namespace rgbd_pose
