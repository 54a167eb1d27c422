#include "frontend/features/patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_pose {
namespace {

// The grey level of an image (CV_8UC1) at a point between pixels, bilinear. It
// must lie inside: 0 <= u < cols - 1, 0 <= v < rows - 1.
inline float SampleImage(const cv::Mat& image, float u, float v) {
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const float s = u - static_cast<float>(column);
  const float t = v - static_cast<float>(row);
  const uint8_t* upper = image.data + image.step * row + column;
  const uint8_t* lower = upper + image.step;
  const float above = upper[0] + s * static_cast<float>(upper[1] - upper[0]);
  const float below = lower[0] + s * static_cast<float>(lower[1] - lower[0]);
  return above + t * (below - above);
}

// A contrast or gradient whose RMS over the patch is below this (grey levels,
// grey levels per px) is the noise of the image.
constexpr float kMinGrey = 0.5F;

// One more on each side than the patch, for its derivatives.
constexpr int kSourceSide = kPatchSize + 2;

using Pixels = Eigen::Array<float, kPatchSize, kPatchSize, Eigen::RowMajor>;
using Seen = Eigen::Array<float, kSourceSide, kSourceSide, Eigen::RowMajor>;

// A surface seen at less than this to its plane (sine of 15 degrees) has a
// normal too uncertain to be used.
constexpr double kMinIncidence = 0.26;

}  // namespace

void MakePatch(const cv::Mat& image, const Eigen::Vector2f& centre,
               const Eigen::Matrix2f& image_from_patch, Patch* patch) {
  constexpr float kMinEnergy = kMinGrey * kMinGrey * Patch::kPixels;
  // Just inside, as SampleImage wants it.
  const float max_u = static_cast<float>(image.cols) - 1.001F;
  const float max_v = static_cast<float>(image.rows) - 1.001F;
  const Eigen::Matrix2f& warp = image_from_patch;
  constexpr int kHalf = kSourceSide / 2;
  Seen seen;
  for (int i = 0; i < kSourceSide; ++i) {
    const auto y = static_cast<float>(i - kHalf);
    for (int j = 0; j < kSourceSide; ++j) {
      const auto x = static_cast<float>(j - kHalf);
      const float u = centre.x() + (warp(0, 0) * x + warp(0, 1) * y);
      const float v = centre.y() + (warp(1, 0) * x + warp(1, 1) * y);
      seen(i, j) = SampleImage(image, std::clamp(u, 0.0F, max_u),
                               std::clamp(v, 0.0F, max_v));
    }
  }
  constexpr int n = kPatchSize;
  Pixels grey = seen.block<n, n>(1, 1);
  Pixels x = 0.5F * (seen.block<n, n>(1, 2) - seen.block<n, n>(1, 0));
  Pixels y = 0.5F * (seen.block<n, n>(2, 1) - seen.block<n, n>(0, 1));
  patch->min_eigenvalue = 0.0F;
  grey -= grey.mean();
  patch->energy = grey.square().sum();
  if (!(patch->energy > kMinEnergy)) return;
  const Pixels contrast = grey / patch->energy;
  x -= x.mean();
  y -= y.mean();
  x -= (x * contrast).sum() * grey;
  y -= (y * contrast).sum() * grey;
  const float xx = x.square().sum();
  const float yy = y.square().sum();
  const float xy = (x * y).sum();
  const float determinant = xx * yy - xy * xy;
  const float smaller =
      0.5F * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4.0F * xy * xy));
  if (!(smaller > kMinEnergy && determinant > 0.0F)) return;
  patch->min_eigenvalue = smaller;
  Eigen::Map<Pixels>(patch->contrast) = contrast;
  Eigen::Map<Pixels>(patch->steps_x) = (yy * x - xy * y) / determinant;
  Eigen::Map<Pixels>(patch->steps_y) = (xx * y - xy * x) / determinant;
}

// Along the plane n . X = const the depth changes so that the point X = z r of
// the ray r = [(u - cx) / fx, (v - cy) / fy, 1] moves by
//   dX/du = z / fx (e_x - n_x / (n . r) r), and v likewise.
Eigen::Matrix2f PlaneWarp(const Camera& camera, const Observation& ref,
                          const Rigid3d& cur_from_ref) {
  const Eigen::Vector3d ray = camera.Ray(ref.u, ref.v);
  Eigen::Vector3d normal = ref.normal;
  if (std::abs(normal.dot(ray)) < kMinIncidence * ray.norm()) {
    normal = Eigen::Vector3d::UnitZ();
  }
  const Eigen::RowVector2d tilt =
      normal.head<2>().transpose() / normal.dot(ray);
  Eigen::Matrix<double, 3, 2> moved;
  moved.leftCols<2>() = -ray * tilt;
  moved(0, 0) += 1.0;
  moved(1, 1) += 1.0;
  moved.col(0) *= ref.depth / camera.fx;
  moved.col(1) *= ref.depth / camera.fy;
  moved = cur_from_ref.rotation.toRotationMatrix() * moved;
  const Eigen::Vector3d point = cur_from_ref * (ref.depth * ray);
  Eigen::Matrix2d warp;
  for (int i = 0; i < 2; ++i) {
    const double f = (i == 0 ? camera.fx : camera.fy) / point.z();
    warp.row(i) = f * (moved.row(i) - point[i] / point.z() * moved.row(2));
  }
  if (camera.HasDistortion()) {
    // Of ideal pixels so far.
    const Eigen::Vector2d focal(camera.fx, camera.fy);
    warp = camera.ProjectDerivative(point.head<2>() / point.z()) *
           focal.cwiseInverse().asDiagonal() * warp * focal.asDiagonal() *
           camera.ProjectDerivative(ray.head<2>()).inverse();
  }
  return warp.cast<float>();
}

}  // namespace rgbd_pose
