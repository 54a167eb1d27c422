#include "frontend/frame/depth_registration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdint>

#include "core/util/input_error.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {
namespace {

constexpr int kBlock = 64;  // pixels projected together

// Values of up to kBlock pixels. Eigen vectorises operations on them.
using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;
using Places = Eigen::Array<int, Eigen::Dynamic, 1, 0, kBlock, 1>;

// The first integers greater than x, clamped to 0 and `end`.
Places FirstBeyond(const Block& x, float end) {
  return (x + 1.0F).max(0.0F).min(end).cast<int>();
}

// Half-open rectangles in an image; that of an unseen pixel is empty.
struct Rectangles {
  Places u0, u1, v0, v1;
};

// Fills rectangles with depths, rounded down, where no nearer depth is yet.
void DrawNearest(const Rectangles& at, const Block& depths, cv::Mat* image) {
  for (Eigen::Index i = 0; i < depths.size(); ++i) {
    if (at.u0[i] >= at.u1[i]) continue;
    // Subtracting one wraps no depth (0) around to the largest depth.
    const auto value = static_cast<uint16_t>(static_cast<int>(depths[i]) - 1);
    for (int v = at.v0[i]; v < at.v1[i]; ++v) {
      auto* out = image->ptr<uint16_t>(v);
      for (int u = at.u0[i]; u < at.u1[i]; ++u) {
        const auto before = static_cast<uint16_t>(out[u] - 1);
        out[u] = static_cast<uint16_t>(std::min(before, value) + 1);
      }
    }
  }
}

// The size of a depth pixel in the colour image at the same depth, px. `place`:
// its ray on the plane z = 1; NaN: none.
Eigen::Vector2d PixelSize(const Camera& depth, const Eigen::Vector2d& place,
                          const Camera& color) {
  if ((!depth.HasDistortion() && !color.HasDistortion()) ||
      !place.allFinite()) {
    return {color.fx / depth.fx, color.fy / depth.fy};
  }
  const Eigen::Matrix2d color_from_depth =
      color.ProjectDerivative(place) * depth.ProjectDerivative(place).inverse();
  return color_from_depth.cwiseAbs().rowwise().sum();
}

}  // namespace

DepthRegistration::DepthRegistration(const DepthCamera& depth,
                                     const Camera& color)
    : color_(color),
      translation_(depth.color_from_depth.translation.cast<float>()),
      width_(depth.camera.width),
      height_(depth.camera.height) {
  RequireSound(depth.camera.Check(), "depth camera: ");
  RequireSound(color.Check(), "colour camera: ");
  if (!depth.color_from_depth.IsFinite()) {
    throw InputError("depth camera: its pose is not finite");
  }
  const Eigen::Matrix3d rotation =
      depth.color_from_depth.rotation.toRotationMatrix();
  // Depth pixels are enlarged by this factor. Otherwise rotation, lens
  // distortion and slanted surfaces would leave gaps of single pixels.
  constexpr double kOverlap = 1.1;
  pixels_.resize(static_cast<Eigen::Index>(width_) * height_, Eigen::NoChange);
  for (int v = 0, i = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u, ++i) {
      const Eigen::Vector3d ray = depth.camera.Unproject({u, v}, 1.0);
      // A pixel for which the lens gives no ray is put behind the camera.
      const Eigen::Vector3d turned =
          ray.allFinite() ? rotation * ray : Eigen::Vector3d(0.0, 0.0, -1e3);
      const Eigen::Vector2d half_size =
          0.5 * kOverlap * PixelSize(depth.camera, ray.head<2>(), color);
      pixels_.row(i) << turned.transpose().cast<float>(),
          half_size.transpose().cast<float>();
    }
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
  const auto lens = color_.MakeLens<float>();
  const float p1 = lens.p1, p2 = lens.p2;
  // Smaller depths (m) are behind the glass of the colour camera.
  constexpr float kMinDepth = 0.01F;
  // A ray with a larger squared tangent is outside every lens, but a polynomial
  // of distortion may fold it back into the image.
  const float max_tangent_squared =
      color_.lens_model == LensModel::kEquidistant ? 100.0F : 4.0F;
  const auto columns = static_cast<float>(registered->cols);
  const auto rows = static_cast<float>(registered->rows);
  using Raw = Eigen::Array<uint16_t, Eigen::Dynamic, 1>;
  for (int begin = 0; begin < width_; begin += kBlock) {
    const int n = std::min(kBlock, width_ - begin);
    const auto first = static_cast<Eigen::Index>(row) * width_ + begin;
    const auto pixels = pixels_.middleRows(first, n);
    const Block raw = Eigen::Map<const Raw>(depth + begin, n).cast<float>();
    const Block z = raw * metres;
    const Block there_z = z * pixels.col(2) + translation_.z();
    const Block inverse = there_z.max(kMinDepth).inverse();
    const Block a = (z * pixels.col(0) + translation_.x()) * inverse;
    const Block b = (z * pixels.col(1) + translation_.y()) * inverse;
    const Block ray_r2 = a * a + b * b;
    const Block r2 = ray_r2.min(max_tangent_squared);
    Block radial;
    lens.Radial(r2, &radial);
    const Block ab = 2.0F * a * b;
    const Block u = fx * (a * radial + p1 * ab + p2 * (r2 + 2.0F * a * a)) + cx;
    const Block v = fy * (b * radial + p1 * (r2 + 2.0F * b * b) + p2 * ab) + cy;
    const Block nearer = z * inverse;
    const Block half_width = pixels.col(3) * nearer;
    const Block half_height = pixels.col(4) * nearer;
    const Block there = there_z * units + 0.5F;
    const auto is_seen = raw > 0.0F && raw < Frame::kNoDepth &&
                         there_z > kMinDepth && ray_r2 < max_tangent_squared &&
                         there < Frame::kNoDepth;
    const Block right = is_seen.select(u + half_width, -1.0F);
    const Rectangles covered = {
        FirstBeyond(u - half_width, columns), FirstBeyond(right, columns),
        FirstBeyond(v - half_height, rows), FirstBeyond(v + half_height, rows)};
    DrawNearest(covered, there, registered);
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
