#pragma once

#include <string>
#include <vector>

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

}  // namespace rgbd_pose
