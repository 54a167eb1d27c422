#include "frontend/simulation/synthetic_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frontend/simulation/synthetic_hash.h"

namespace rgbd_pose {
namespace {

// Sets those pixels of a row to 0 that the projector, right of the camera, does
// not reach. It sees a point kDisparity / depth pixels further left, where the
// points of a row keep their order unless they are hidden.
void DropShadow(int columns, float* row) {
  constexpr auto kDisparity =
      static_cast<float>(1.0 / (8.0 * kInverseDepthStep));  // px m
  constexpr float kTolerance = 1.0f;                        // px
  float leftmost = std::numeric_limits<float>::max();
  for (int u = columns - 1; u >= 0; --u) {
    if (row[u] == 0.0f) continue;
    const float seen_at = static_cast<float>(u) - kDisparity / row[u];
    if (seen_at > leftmost + kTolerance) {
      row[u] = 0.0f;
    } else {
      leftmost = std::min(leftmost, seen_at);
    }
  }
}

// Approximate distance (px) that the nearest object moves in the image.
double BlurLength(const Rigid3d& motion, const cv::Mat& depth,
                  double focal_px) {
  double nearest = 0.0, farthest = 0.0;
  cv::minMaxLoc(depth, &nearest, &farthest, nullptr, nullptr, depth > 0.0f);
  const double shift =
      farthest > 0.0 ? motion.translation.norm() / nearest : 0.0;
  return focal_px * (motion.Angle() + shift);
}

}  // namespace

cv::Mat EncodeDepth(const cv::Mat& depth_m, double depth_scale) {
  cv::Mat raw;
  depth_m.convertTo(raw, CV_16UC1, depth_scale);
  return raw;
}

cv::Mat MeasureDepth(const cv::Mat& depth_m, double focal_px, uint64_t key) {
  const auto max_step = static_cast<float>(
      std::tan(kMaxSensorSlantDeg * M_PI / 180.0) / focal_px);
  constexpr auto kStep = static_cast<float>(kInverseDepthStep);
  constexpr auto kSigma = static_cast<float>(kDisparitySigma);
  cv::Mat measured = cv::Mat::zeros(depth_m.size(), CV_32FC1);
  for (int v = 0; v < depth_m.rows; ++v) {
    const float* row = depth_m.ptr<float>(v);
    const float* above = depth_m.ptr<float>(std::max(v - 1, 0));
    const float* below = depth_m.ptr<float>(std::min(v + 1, depth_m.rows - 1));
    float* out = measured.ptr<float>(v);
    for (int u = 0; u < depth_m.cols; ++u) {
      const float z = row[u];
      if (z < kMinSensorDepth || z > kMaxSensorDepth) continue;
      // The surface there is too steep, or there is a depth edge.
      const auto is_off = [=](float other) {
        return std::abs(z - other) > max_step * std::min(z, other);
      };
      if (is_off(row[std::max(u - 1, 0)]) || is_off(above[u]) ||
          is_off(row[std::min(u + 1, depth_m.cols - 1)]) || is_off(below[u])) {
        continue;
      }
      out[u] = z;
    }
    DropShadow(depth_m.cols, out);
    const uint64_t first = key + static_cast<uint64_t>(v) * depth_m.cols;
    for (int u = 0; u < depth_m.cols; ++u) {
      if (out[u] == 0.0f) continue;
      const float noise = kSigma * GaussianFromBits(HashCounter(first + u));
      out[u] = 1.0f / (kStep * std::round(1.0f / (kStep * out[u]) + noise));
    }
  }
  return measured;
}

void AddColorNoise(uint64_t key, cv::Mat* color) {
  const int values = color->cols * color->channels();
  for (int v = 0; v < color->rows; ++v) {
    uint8_t* row = color->ptr<uint8_t>(v);
    const uint64_t first = key + static_cast<uint64_t>(v) * values;
    for (int i = 0; i < values; ++i) {
      const float noise = static_cast<float>(kColorSigma) *
                          GaussianFromBits(HashCounter(first + i));
      row[i] = cv::saturate_cast<uint8_t>(static_cast<float>(row[i]) + noise);
    }
  }
}

double DriftingGain(double amplitude, double t) {
  return std::exp(amplitude * std::sin(2.0 * M_PI * t / kExposurePeriod));
}

Rendering Expose(const Renderer& renderer, double focal_px,
                 const std::function<Rigid3d(double t)>& world_from_cam,
                 double t, const Exposure& exposure) {
  constexpr double kInvisibleBlur = 0.1;  // px
  const double half_time = exposure.shutter_s / 2.0;
  Rendering out = renderer.Render(world_from_cam, t, exposure.readout_s);
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
      const Rendering moved = renderer.Render(world_from_cam, t + side * offset,
                                              exposure.readout_s);
      cv::add(sum, moved.color, sum, cv::noArray(), CV_32F);
    }
  }
  sum.convertTo(out.color, CV_8U, exposure.gain / renderings);
  return out;
}

}  // namespace rgbd_pose
