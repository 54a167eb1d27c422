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

void ObservationArray::reserve(size_t n) {
  ForEachColumn([n](std::vector<double>* column) { column->reserve(n); });
}

void ObservationArray::clear() {
  ForEachColumn([](std::vector<double>* column) { column->clear(); });
}

void ObservationArray::push_back(const Observation& o) {
  u_.push_back(o.u);
  v_.push_back(o.v);
  depth_.push_back(o.depth);
  sigma_px_.push_back(o.sigma_px);
  sigma_depth_.push_back(o.sigma_depth);
  nx_.push_back(o.normal.x());
  ny_.push_back(o.normal.y());
  nz_.push_back(o.normal.z());
}

bool Correspondences::Add(const Observation& prev, const Observation& cur) {
  if (!IsUsable(prev) || !IsUsable(cur)) {
    ++rejected_;
    return false;
  }
  prev_.push_back(prev);
  cur_.push_back(cur);
  return true;
}

void Correspondences::Clear() {
  prev_.clear();
  cur_.clear();
  rejected_ = 0;
}

void Correspondences::Reserve(size_t n) {
  prev_.reserve(n);
  cur_.reserve(n);
}

}  // namespace rgbd_pose
