#include "apps/report/report_thinning.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbd_pose {
namespace {

using nlohmann::json;

// Dividing by a power of ten gives the number nearest to the short decimal,
// which is then written with as few digits.
json Rounded(double value, int decimals) {
  if (!std::isfinite(value)) return nullptr;
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

}  // namespace

std::vector<double> Elapsed(std::vector<double> times) {
  for (size_t i = times.size(); i-- > 0;) times[i] -= times[0];
  return times;
}

ReportThinning::ReportThinning(size_t frames, size_t max_points)
    : every_(std::max<size_t>((frames + max_points - 1) / max_points, 1)) {}

json ReportThinning::First(const std::vector<double>& values,
                           int decimals) const {
  json result = json::array();
  for (size_t i = 0; i < values.size(); i += every_) {
    result.push_back(Rounded(values[i], decimals));
  }
  return result;
}

json ReportThinning::Largest(const std::vector<double>& values,
                             int decimals) const {
  json result = json::array();
  for (size_t i = 0; i < values.size(); i += every_) {
    double largest = std::numeric_limits<double>::quiet_NaN();
    const size_t end = std::min(i + every_, values.size());
    for (size_t k = i; k < end; ++k) {
      if (!(largest >= values[k]) && !std::isnan(values[k])) {
        largest = values[k];
      }
    }
    result.push_back(Rounded(largest, decimals));
  }
  return result;
}

}  // namespace rgbd_pose
