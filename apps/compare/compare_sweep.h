#pragma once

#include <string>
#include <vector>

#include "apps/pipeline/settings.h"

namespace rgbd_pose {

// A median of a sample and what the sample says of the population's.
struct MedianBand {
  double median = 0.0;
  double low = 0.0;   // the population's median is within [low, high] in 95 %
  double high = 0.0;  // of all samples or more, whatever the distribution
  double p90 = 0.0;   // nine of ten are not above it
};

// The rank r (from 0) such that the r-th smallest and the r-th greatest of
// `count` values enclose the population's median with a probability of 95 % or
// more: order statistics, the number of values below the median being binomial
// (David & Nagaraja, Order Statistics, 2003, 7.1). 0, so smallest and greatest,
// if there are too few (5 or less) for such a rank.
int MedianBandRank(int count);

// All NaN of no values.
MedianBand FindMedianBand(std::vector<double> values);

// "median [low, high]", three digits each.
std::string FormatBand(const MedianBand& band);

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

// All ways to go with these losses, ordered by loss, schedule, start.
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
