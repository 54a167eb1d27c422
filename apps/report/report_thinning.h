#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace rgbd_pose {

// Times since the first frame, s.
std::vector<double> Elapsed(std::vector<double> times);

// Puts frames in groups of `every`, each drawn as one point, so that a page
// stays small.
class ReportThinning {
 public:
  ReportThinning(size_t frames, size_t max_points);

  size_t every() const { return every_; }

  // The first of each group; null where a value is not finite.
  nlohmann::json First(const std::vector<double>& values, int decimals) const;

  // The largest of each group, so that no peak is lost; null where there is
  // none.
  nlohmann::json Largest(const std::vector<double>& values, int decimals) const;

 private:
  size_t every_;
};

}  // namespace rgbd_pose
