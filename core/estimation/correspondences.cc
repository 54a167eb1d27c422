#include "core/estimation/correspondences.h"

#include <cmath>

namespace rgbd_pose {
namespace {

bool IsUsable(const Observation& o) {
  const bool finite = std::isfinite(o.u) && std::isfinite(o.v) &&
                      std::isfinite(o.depth) && std::isfinite(o.sigma_px) &&
                      std::isfinite(o.sigma_depth) && o.normal.allFinite();
  return finite && o.depth >= 0.0 && o.sigma_px > 0.0 &&
         (o.depth == 0.0 || o.sigma_depth > 0.0);
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

void Correspondences::Clear() {
  matches_.clear();
  rejected_ = 0;
}

}  // namespace rgbd_pose
