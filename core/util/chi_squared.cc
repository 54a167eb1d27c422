#include "core/util/chi_squared.h"

#include <algorithm>
#include <array>

namespace rgbd_pose {
namespace {

constexpr std::array<double, 6> kMedian = {0.454936, 1.386294, 2.365974,
                                           3.356694, 4.351460, 5.348121};
constexpr std::array<double, 6> k99 = {6.634897,  9.210340,  11.344867,
                                       13.276704, 15.086272, 16.811894};

}  // namespace

double ChiSquaredMedian(int degrees) {
  return kMedian[std::clamp(degrees, 1, 6) - 1];
}

double ChiSquared99(int degrees) { return k99[std::clamp(degrees, 1, 6) - 1]; }

}  // namespace rgbd_pose
