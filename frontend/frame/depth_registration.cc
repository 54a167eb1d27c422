#include "frontend/frame/depth_registration.h"

#include <algorithm>
#include <cstdint>

#include "core/util/input_error.h"
#include "frontend/frame/frame.h"

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

// Values of up to kBlock pixels; the library makes vectors of what is done with
// them.
using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;
using Places = Eigen::Array<int, Eigen::Dynamic, 1, 0, kBlock, 1>;

// The first whole numbers beyond x, between 0 and `end`.
Places FirstBeyond(const Block& x, float end) {
  return (x + 1.0F).max(0.0F).min(end).cast<int>();
}

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
  const auto columns = static_cast<float>(registered->cols);
  const auto rows = static_cast<float>(registered->rows);
  using Raw = Eigen::Array<uint16_t, Eigen::Dynamic, 1>;
  for (int begin = 0; begin < width_; begin += kBlock) {
    const int n = std::min(kBlock, width_ - begin);
    const size_t first = static_cast<size_t>(row) * width_ + begin;
    using Rays = Eigen::Map<const Eigen::ArrayXf>;
    const Block raw = Eigen::Map<const Raw>(depth + begin, n).cast<float>();
    const Block z = raw * metres;
    const Block there_z = z * Rays(&ray_z_[first], n) + translation_.z();
    const Block inverse = there_z.max(kMinDepth).inverse();
    const Block a = (z * Rays(&ray_x_[first], n) + translation_.x()) * inverse;
    const Block b = (z * Rays(&ray_y_[first], n) + translation_.y()) * inverse;
    const Block ray_r2 = a * a + b * b;
    const Block r2 = ray_r2.min(kMaxTangentSquared);
    const Block radial = 1.0F + r2 * (k1 + r2 * (k2 + r2 * k3));
    const Block ab = 2.0F * a * b;
    const Block u = fx * (a * radial + p1 * ab + p2 * (r2 + 2.0F * a * a)) + cx;
    const Block v = fy * (b * radial + p1 * (r2 + 2.0F * b * b) + p2 * ab) + cy;
    const Block nearer = z * inverse;
    const Block there = there_z * units + 0.5F;
    const auto is_seen = raw > 0.0F && raw < Frame::kNoDepth &&
                         there_z > kMinDepth && ray_r2 < kMaxTangentSquared &&
                         there < Frame::kNoDepth;
    // Half-open rectangles: those of neighbours do not overlap. What is not
    // seen has none.
    const Block right = is_seen.select(u + half_width_ * nearer, -1.0F);
    const Places u0 = FirstBeyond(u - half_width_ * nearer, columns);
    const Places u1 = FirstBeyond(right, columns);
    const Places v0 = FirstBeyond(v - half_height_ * nearer, rows);
    const Places v1 = FirstBeyond(v + half_height_ * nearer, rows);
    for (int i = 0; i < n; ++i) {
      if (u0[i] >= u1[i]) continue;
      // One less, so that none (0) is farther than all others.
      const auto value = static_cast<uint16_t>(static_cast<int>(there[i]) - 1);
      for (int at_v = v0[i]; at_v < v1[i]; ++at_v) {
        auto* out = registered->ptr<uint16_t>(at_v);
        for (int at_u = u0[i]; at_u < u1[i]; ++at_u) {
          const auto before = static_cast<uint16_t>(out[at_u] - 1);
          out[at_u] = static_cast<uint16_t>(std::min(before, value) + 1);
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
