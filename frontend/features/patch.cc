#include "frontend/features/patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/util/vector_lanes.h"

namespace rgbd_pose {
namespace {

// Returns the grey level of an image (CV_8UC1) between pixels, bilinear. The
// point must lie inside: 0 <= u < cols - 1, 0 <= v < rows - 1.
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

// The patch and one more pixel on each side for its derivatives.
constexpr int kSourceSide = kPatchSize + 2;

using Pixels = Eigen::Array<float, kPatchSize, kPatchSize, Eigen::RowMajor>;
using Seen = Eigen::Array<float, kSourceSide, kSourceSide, Eigen::RowMajor>;

// A row of a patch. It has the same width on every machine; the compiler splits
// it if registers are narrower.
typedef float Row __attribute__((vector_size(kPatchSize * sizeof(float))));
typedef int32_t IntRow
    __attribute__((vector_size(kPatchSize * sizeof(int32_t))));
typedef uint16_t ShortRow
    __attribute__((vector_size(kPatchSize * sizeof(uint16_t))));
typedef uint8_t ByteRow __attribute__((vector_size(kPatchSize)));

void Load(const float* from, Row* row) { std::memcpy(row, from, sizeof(*row)); }

// Widens step by step: compilers convert bytes directly to floats one by one.
void Load(const uint8_t* from, Row* row) {
  ByteRow bytes;
  std::memcpy(&bytes, from, sizeof(bytes));
  const ShortRow shorts = __builtin_convertvector(bytes, ShortRow);
  const IntRow ints = __builtin_convertvector(shorts, IntRow);
  *row = __builtin_convertvector(ints, Row);
}

float Total(const Row& row) {
  return ((row[0] + row[4]) + (row[1] + row[5])) +
         ((row[2] + row[6]) + (row[3] + row[7]));
}
static_assert(kPatchSize == 8, "Total adds up 8");

// The sums over an image patch that an iteration needs.
struct Sums {
  float x, y;           // with the patch's steps
  float contrast;       // with the patch's contrast
  float grey, squares;  // of the grey levels
};

// Sums over the image patch whose upper left pixel is `corner`, shifted by s
// and t (0..1) to the right and down.
void SumUp(const Patch& patch, const uint8_t* corner, size_t stride, float s,
           float t, Sums* sums) {
  Row x{}, y{}, contrast{}, grey{}, squares{};
  Row above{};
  for (int i = 0; i <= kPatchSize; ++i) {
    Row left, right;
    Load(corner + i * stride, &left);
    Load(corner + i * stride + 1, &right);
    const Row row = left + s * (right - left);
    if (i > 0) {
      const Row value = above + t * (row - above);
      const int k = (i - 1) * kPatchSize;
      Row weight;
      Load(patch.steps_x + k, &weight);
      x += weight * value;
      Load(patch.steps_y + k, &weight);
      y += weight * value;
      Load(patch.contrast + k, &weight);
      contrast += weight * value;
      grey += value;
      squares += value * value;
    }
    above = row;
  }
  *sums = {Total(x), Total(y), Total(contrast), Total(grey), Total(squares)};
}

struct AlignKernel {
  template <int W>
  static void Run(const Patch& patch, const cv::Mat& image, float start_u,
                  float start_v, float min_step_px,
                  AlignedPatch* const& result) {
    constexpr int kHalf = kPatchSize / 2;
    constexpr int kMaxIterations = 8;
    // Farther (px, along each axis) from the start, the patch and the image
    // there have too little in common.
    constexpr float kMaxShiftPx = 3.0F;
    // With a smaller share of its contrast, the image does not show the patch.
    constexpr float kMinGain = 0.1F;
    const auto max_column = static_cast<float>(image.cols - kHalf);
    const auto max_row = static_cast<float>(image.rows - kHalf);
    float u = start_u;
    float v = start_v;
    Sums sums = {};
    for (int i = 0; i < kMaxIterations; ++i) {
      if (!(u >= kHalf && v >= kHalf && u < max_column && v < max_row)) return;
      const int column = static_cast<int>(u);
      const int row = static_cast<int>(v);
      SumUp(patch, image.data + image.step * (row - kHalf) + (column - kHalf),
            image.step, u - static_cast<float>(column),
            v - static_cast<float>(row), &sums);
      if (!(sums.contrast > kMinGain)) return;
      const float step_u = sums.x / sums.contrast;
      const float step_v = sums.y / sums.contrast;
      u -= step_u;
      v -= step_v;
      if (!(std::abs(u - start_u) <= kMaxShiftPx &&
            std::abs(v - start_v) <= kMaxShiftPx)) {
        return;
      }
      if (step_u * step_u + step_v * step_v < min_step_px * min_step_px) break;
    }
    const float energy = sums.squares - sums.grey * sums.grey / Patch::kPixels;
    const float explained = sums.contrast * sums.contrast * patch.energy;
    const float left = std::max(energy - explained, 0.0F) / Patch::kPixels;
    *result = {true, u, v,
               std::sqrt(explained / (explained + left * Patch::kPixels)),
               std::sqrt(left) / sums.contrast};
  }
};

}  // namespace

void MakePatch(const cv::Mat& image, const Eigen::Vector2f& centre,
               const Eigen::Matrix2f& image_from_patch, Patch* patch) {
  // A contrast or gradient with a smaller RMS over the patch (grey levels, grey
  // levels per px) is image noise.
  constexpr float kMinGrey = 0.5F;
  constexpr float kMinEnergy = kMinGrey * kMinGrey * Patch::kPixels;
  // Just inside, as required by SampleImage.
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

// Along the plane n . X = const the depth changes, and the point X = z r of the
// ray r = [(u - cx) / fx, (v - cy) / fy, 1] moves by
//   dX/du = z / fx (e_x - n_x / (n . r) r), and similarly for v.
Eigen::Matrix2f PlaneWarp(const Camera& camera, const Observation& ref,
                          const Rigid3d& cur_from_ref) {
  // A surface seen at a smaller angle to its plane (sine of 15 degrees) has a
  // normal too uncertain to be used.
  constexpr double kMinIncidence = 0.26;
  const Eigen::Vector3d ray = camera.Ray(ref.u, ref.v);
  Eigen::Vector3d normal = ref.normal;
  if (std::abs(normal.dot(ray)) < kMinIncidence * ray.norm()) {
    normal = Eigen::Vector3d::UnitZ();
  }
  const Eigen::RowVector2d tilt =
      normal.head<2>().transpose() / normal.dot(ray);
  Eigen::Matrix<double, 3, 2> moved =
      Eigen::Matrix<double, 3, 2>::Identity() - ray * tilt;
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
    // So far the warp is between ideal pixels.
    const Eigen::Vector2d focal(camera.fx, camera.fy);
    warp = camera.ProjectDerivative(point.head<2>() / point.z()) *
           focal.cwiseInverse().asDiagonal() * warp * focal.asDiagonal() *
           camera.ProjectDerivative(ray.head<2>()).inverse();
  }
  return warp.cast<float>();
}

AlignedPatch AlignPatch(const Patch& patch, const cv::Mat& image, float start_u,
                        float start_v, float min_step_px) {
  AlignedPatch result;
  if (patch.min_eigenvalue > 0.0F) {
    RunVectorised<AlignKernel>(patch, image, start_u, start_v, min_step_px,
                               &result);
  }
  return result;
}

}  // namespace rgbd_pose
