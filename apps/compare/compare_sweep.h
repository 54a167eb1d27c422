#pragma once

#include <string>
#include <vector>

#include "apps/pipeline/settings.h"

namespace rgbd_pose {

// The median of a sample with its confidence interval.
struct MedianBand {
  double median = 0.0;
  double low = 0.0;   // [low, high] contains the population's median
  double high = 0.0;  // in at least 95 % of samples, for any distribution
  double p90 = 0.0;   // 90 % quantile
};

// Returns the rank r (from 0) for which the r-th smallest and the r-th largest
// of `count` values enclose the population's median with a probability of at
// least 95 %. It uses order statistics: the number of values below the median
// is binomial (David & Nagaraja, Order Statistics, 2003, 7.1). Returns 0
// (smallest and largest value) if 5 or fewer values allow no such rank.
int MedianBandRank(int count);

// All NaN if there are no values.
MedianBand FindMedianBand(std::vector<double> values);

// "median [low, high]", three digits each.
std::string FormatBand(const MedianBand& band);

struct SweepOptions {
  std::vector<std::string> losses;
  EstimatorSettings estimator;  // without loss and schedule
  int seeds = 200;              // random motions with matches, per share
  int matches = 300;            // number of inliers and outliers together
  int threads = 1;              // does not affect the result
};

// A method to estimate a motion from matches.
struct SweepMethod {
  std::string loss;
  std::string schedule;  // gnc or direct
  bool ransac = false;   // starts from RANSAC, else from no motion
};

// All methods with these losses, ordered by loss, schedule and start.
std::vector<SweepMethod> SweepMethods(const std::vector<std::string>& losses);

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

// Estimates the motions of simulated matches, some of them wrong, with every
// loss, schedule and start. All methods use the same matches. Ordered by loss,
// schedule, start, share. Throws InputError for unknown names.
std::vector<SweepCell> RunSweep(const SweepOptions& options);

// The cells of one method, ordered by share; empty if the method was not run.
std::vector<SweepCell> CellsOf(const std::vector<SweepCell>& cells,
                               const SweepMethod& method);

// The losses of a sweep in order.
std::vector<std::string> LossesOf(const std::vector<SweepCell>& cells);

}  // namespace rgbd_pose
