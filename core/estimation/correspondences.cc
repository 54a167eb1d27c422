#include "core/estimation/correspondences.h"

#include <cmath>

namespace rgbd_pose {
namespace {

// No camera measures values (px, m) outside these limits, and squared residuals
// stay finite within them. NaN is outside.
constexpr double kHuge = 1e6;
constexpr double kTiny = 1e-9;

bool IsPlace(double value) { return std::abs(value) < kHuge; }
bool IsPositive(double value) { return value > kTiny && value < kHuge; }

bool IsUsable(const Observation& o) {
  const bool has_depth = IsPositive(o.depth) && IsPositive(o.sigma_depth);
  return IsPlace(o.u) && IsPlace(o.v) && IsPositive(o.sigma_px) &&
         (o.normal.array().abs() < kHuge).all() &&
         (has_depth || (o.depth == 0.0 && IsPlace(o.sigma_depth)));
}

}  // namespace

bool Correspondences::Add(const Observation& prev, const Observation& cur) {
  if (!IsUsable(prev) || !IsUsable(cur)) {
    ++rejected_;
    return false;
  }
  matches_.push_back({prev, cur});
  return true;
}

}  // namespace rgbd_pose
