#include "frontend/simulation/synthetic_exposure.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/shutter.h"

namespace rgbd_pose {
namespace {

constexpr double kInvisibleBlur = 0.1;  // px

// About how far (px) the nearest thing moves through the image.
double BlurLength(const Rigid3d& motion, const cv::Mat& depth,
                  double focal_px) {
  double nearest = 0.0;
  double farthest = 0.0;
  cv::minMaxLoc(depth, &nearest, &farthest, nullptr, nullptr, depth > 0.0f);
  const double shift =
      farthest > 0.0 ? motion.translation.norm() / nearest : 0.0;
  return focal_px * (motion.Angle() + shift);
}

// What the camera sees in an instant, or row after row with time t in the
// middle of the readout.
Rendering RenderAt(const Renderer& renderer,
                   const std::function<Rigid3d(double t)>& world_from_cam,
                   double t, double readout_s) {
  if (readout_s == 0.0) return renderer.Render(world_from_cam(t), t);
  std::vector<StampedPose> poses(renderer.num_bands());
  for (size_t i = 0; i < poses.size(); ++i) {
    const double row = renderer.BandMiddle(static_cast<int>(i));
    const Shutter shutter = {0.0, readout_s};
    const double time = t + shutter.RowTime(row, renderer.height());
    poses[i] = {time, world_from_cam(time)};
  }
  return renderer.Render(poses);
}

}  // namespace

double DriftingGain(double amplitude, double t) {
  return std::exp(amplitude * std::sin(2.0 * M_PI * t / kExposurePeriod));
}

Rendering Expose(const Renderer& renderer, double focal_px,
                 const std::function<Rigid3d(double t)>& world_from_cam,
                 double t, const Exposure& exposure) {
  const double half_time = exposure.shutter_s / 2.0;
  Rendering out = RenderAt(renderer, world_from_cam, t, exposure.readout_s);
  const Rigid3d closing_from_opening =
      world_from_cam(t + half_time).Inverse() * world_from_cam(t - half_time);
  const double length = BlurLength(closing_from_opening, out.depth, focal_px);
  const int pairs =
      length < kInvisibleBlur
          ? 0
          : static_cast<int>(std::ceil(length / (2.0 * kMaxBlurStep)));
  const int renderings = 2 * pairs + 1;
  cv::Mat sum;
  out.color.convertTo(sum, CV_32F);
  for (int i = 1; i <= pairs; ++i) {
    const double offset = exposure.shutter_s * i / renderings;
    for (const double side : {-1.0, 1.0}) {
      const Rendering moved = RenderAt(renderer, world_from_cam,
                                       t + side * offset, exposure.readout_s);
      cv::add(sum, moved.color, sum, cv::noArray(), CV_32F);
    }
  }
  sum.convertTo(out.color, CV_8U, exposure.gain / renderings);
  return out;
}

}  // namespace rgbd_pose
