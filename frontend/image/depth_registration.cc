#include "frontend/image/depth_registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/util/input_error.h"
#include "frontend/image/frame.h"

namespace rgbd_pose {
namespace {

constexpr int kBlock = 64;  // pixels projected together

// Distances nearer than this (m) are behind the colour camera's glass.
constexpr float kMinDepth = 0.01F;

// Depth pixels count as this much wider than they are: turned, stretched by a
// lens or on a slope, they would leave gaps of single pixels between them.
constexpr double kOverlap = 1.1;

// Beyond this square of its tangent a ray is outside every lens that radial
// distortion describes: its polynomial may fold such rays back into the image.
constexpr float kMaxTangentSquared = 4.0F;

void RequireCamera(const Camera& camera, const char* what) {
  const std::string problem = camera.Check();
  if (!problem.empty()) throw InputError(what + (": " + problem));
}

}  // namespace

DepthRegistration::DepthRegistration(const DepthCamera& depth,
                                     const Camera& color)
    : color_(color),
      translation_(depth.color_from_depth.translation.cast<float>()),
      width_(depth.camera.width),
      height_(depth.camera.height),
      half_width_(
          static_cast<float>(0.5 * kOverlap * color.fx / depth.camera.fx)),
      half_height_(
          static_cast<float>(0.5 * kOverlap * color.fy / depth.camera.fy)) {
  RequireCamera(depth.camera, "depth camera");
  RequireCamera(color, "colour camera");
  if (!depth.color_from_depth.IsFinite()) {
    throw InputError("depth camera: its place is no finite motion");
  }
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(static_cast<size_t>(width_) * height_);
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) pixels.emplace_back(u, v);
  }
  depth.camera.UndistortPoints(&pixels);
  for (std::vector<float>* axis : {&ray_x_, &ray_y_, &ray_z_}) {
    axis->reserve(pixels.size());
  }
  const Eigen::Matrix3d rotation =
      depth.color_from_depth.rotation.toRotationMatrix();
  for (const Eigen::Vector2d& pixel : pixels) {
    const Eigen::Vector3d ray =
        rotation * depth.camera.Ray(pixel.x(), pixel.y());
    ray_x_.push_back(static_cast<float>(ray.x()));
    ray_y_.push_back(static_cast<float>(ray.y()));
    ray_z_.push_back(static_cast<float>(ray.z()));
  }
}

void DepthRegistration::RegisterRow(const uint16_t* depth, int row,
                                    double units_per_metre,
                                    cv::Mat* registered) const {
  const auto units = static_cast<float>(units_per_metre);
  const float metres = 1.0F / units;
  const auto fx = static_cast<float>(color_.fx);
  const auto fy = static_cast<float>(color_.fy);
  const auto cx = static_cast<float>(color_.cx);
  const auto cy = static_cast<float>(color_.cy);
  const auto k1 = static_cast<float>(color_.k1);
  const auto k2 = static_cast<float>(color_.k2);
  const auto k3 = static_cast<float>(color_.k3);
  const auto p1 = static_cast<float>(color_.p1);
  const auto p2 = static_cast<float>(color_.p2);
  const float tx = translation_.x();
  const float ty = translation_.y();
  const float tz = translation_.z();
  std::array<float, kBlock> left, right, top, bottom, units_there;
  for (int begin = 0; begin < width_; begin += kBlock) {
    const int n = std::min(kBlock, width_ - begin);
    const size_t first = static_cast<size_t>(row) * width_ + begin;
    const float* ray_x = &ray_x_[first];
    const float* ray_y = &ray_y_[first];
    const float* ray_z = &ray_z_[first];
    const uint16_t* raw = depth + begin;
    // Without branches, so that the compiler makes vectors of it.
    for (int i = 0; i < n; ++i) {
      const float z = static_cast<float>(raw[i]) * metres;
      const float there_z = z * ray_z[i] + tz;
      const float safe_z = std::max(there_z, kMinDepth);
      const float inverse = 1.0F / safe_z;
      const float a = (z * ray_x[i] + tx) * inverse;
      const float b = (z * ray_y[i] + ty) * inverse;
      const float r2 = a * a + b * b;
      const float radial = 1.0F + r2 * (k1 + r2 * (k2 + r2 * k3));
      const float ab = a * b;
      const float u =
          fx * (a * radial + 2.0F * p1 * ab + p2 * (r2 + 2.0F * a * a)) + cx;
      const float v =
          fy * (b * radial + p1 * (r2 + 2.0F * b * b) + 2.0F * p2 * ab) + cy;
      const float nearer = z * inverse;
      left[i] = u - half_width_ * nearer;
      right[i] = u + half_width_ * nearer;
      top[i] = v - half_height_ * nearer;
      bottom[i] = v + half_height_ * nearer;
      const bool is_seen = (raw[i] != 0) & (raw[i] != Frame::kNoDepth) &
                           (there_z > kMinDepth) & (r2 < kMaxTangentSquared);
      units_there[i] = is_seen ? there_z * units + 0.5F : 0.0F;
    }
    for (int i = 0; i < n; ++i) {
      // Half-open rectangles: those of neighbours do not overlap.
      const float last_column = static_cast<float>(registered->cols);
      const float last_row = static_cast<float>(registered->rows);
      const bool is_inside = units_there[i] >= 1.0F &&
                             units_there[i] < Frame::kNoDepth &&
                             right[i] > 0.0F && bottom[i] > 0.0F &&
                             left[i] < last_column && top[i] < last_row;
      if (!is_inside) continue;
      const auto value = static_cast<uint16_t>(units_there[i]);
      const int u0 = std::max(0, static_cast<int>(std::ceil(left[i])));
      const int u1 =
          std::min(registered->cols, static_cast<int>(std::ceil(right[i])));
      const int v0 = std::max(0, static_cast<int>(std::ceil(top[i])));
      const int v1 =
          std::min(registered->rows, static_cast<int>(std::ceil(bottom[i])));
      for (int v = v0; v < v1; ++v) {
        auto* out = registered->ptr<uint16_t>(v);
        for (int u = u0; u < u1; ++u) {
          if (out[u] == 0 || value < out[u]) out[u] = value;
        }
      }
    }
  }
}

cv::Mat DepthRegistration::Register(const cv::Mat& depth,
                                    double units_per_metre) const {
  cv::Mat registered = cv::Mat::zeros(color_.height, color_.width, CV_16UC1);
  for (int row = 0; row < height_; ++row) {
    RegisterRow(depth.ptr<uint16_t>(row), row, units_per_metre, &registered);
  }
  return registered;
}

}  // namespace rgbd_pose
