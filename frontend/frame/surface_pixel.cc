#include "frontend/frame/surface_pixel.h"

#include <cmath>
#include <cstdlib>

#include "frontend/frame/frame.h"

namespace rgbd_pose {
namespace {

// Neighbouring pixels on one surface differ by noise and by slope. Noise: 4
// standard deviations of a difference, which has sqrt(2) times that of a depth.
// Slope: a surface seen at 80 degrees, at f = 525 px.
constexpr double kMaxNoiseStep = 4.0 * M_SQRT2;  // of the depth's sigma
constexpr double kMaxSlopeStep = 0.011;          // of the depth

// A pixel with fewer neighbours (of 4) hangs in the air.
constexpr int kMinNeighbours = 2;

}  // namespace

double MaxSurfaceStep(double depth, const DepthNoiseModel& noise) {
  return kMaxNoiseStep * noise.sigma(depth) + kMaxSlopeStep * depth;
}

bool IsOnSurface(const cv::Mat& depth, int x, int y, int max_step) {
  const uint16_t* row = depth.ptr<uint16_t>(y);
  const int raw = row[x];
  int neighbours = 0;
  for (const uint16_t other :
       {row[x - 1], row[x + 1], depth.ptr<uint16_t>(y - 1)[x],
        depth.ptr<uint16_t>(y + 1)[x]}) {
    if (other == 0 || other == Frame::kNoDepth) continue;
    if (std::abs(other - raw) > max_step) return false;
    ++neighbours;
  }
  return neighbours >= kMinNeighbours;
}

}  // namespace rgbd_pose
