#pragma once

#include <string>
#include <vector>

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
// least 95 %: the number of values below it is binomial (David & Nagaraja,
// Order Statistics, 2003, 7.1). 0 if 5 or fewer values allow no such rank.
int MedianBandRank(int count);

// All NaN if there are no values.
MedianBand FindMedianBand(std::vector<double> values);

// A method to estimate a motion from matches.
struct SweepMethod {
  std::string loss;
  std::string schedule;  // gnc or direct
  bool ransac = false;   // starts from RANSAC, else from identity

  // Whether both are the same method.
  bool operator==(const SweepMethod& other) const {
    return loss == other.loss && schedule == other.schedule &&
           ransac == other.ransac;
  }
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

// The cells of one method, ordered by share; empty if the method was not run.
std::vector<SweepCell> CellsOf(const std::vector<SweepCell>& cells,
                               const SweepMethod& method);

std::vector<std::string> LossesOf(const std::vector<SweepCell>& cells);

// sweep.csv: a header and one row per cell.
std::string SweepCsv(const std::vector<SweepCell>& cells);

// Reads sweep.csv. Throws InputError if it is missing, broken or incomplete.
std::vector<SweepCell> ReadSweepCsv(const std::string& path);

// Median translation errors (mm) with their 95 % bands for the graduated losses
// that start from identity: one row per loss, one column per share.
std::string SweepTable(const std::vector<SweepCell>& cells);

// Describes the result of a sweep with its figures: the best M-estimator, its
// margin and spread, and the effect of a start from RANSAC.
std::string SweepVerdict(const std::vector<SweepCell>& cells);

}  // namespace rgbd_pose
