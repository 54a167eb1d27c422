#include "frontend/features/patch_alignment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/util/vector_lanes.h"

namespace rgbd_pose {
namespace {

// Below this share of the patch's contrast there is nothing like it.
constexpr float kMinGain = 0.1F;

// A row of a patch. The same width on every machine: the compiler splits it
// where the registers are narrower.
typedef float Row __attribute__((vector_size(kPatchSize * sizeof(float))));
typedef int32_t IntRow
    __attribute__((vector_size(kPatchSize * sizeof(int32_t))));
typedef uint16_t ShortRow
    __attribute__((vector_size(kPatchSize * sizeof(uint16_t))));
typedef uint8_t ByteRow __attribute__((vector_size(kPatchSize)));

void Load(const float* from, Row* row) { std::memcpy(row, from, sizeof(*row)); }

// Width by width: straight from bytes to floats compilers go pixel by pixel.
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

// The sums over an image patch that a step takes.
struct Sums {
  float x, y;           // with the patch's steps
  float contrast;       // with the patch's contrast
  float grey, squares;  // of the grey levels
};

// Of the image patch whose upper left pixel is `corner`, moved by s and t
// (0..1) to the right and down.
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
                  float start_v, const PatchAlignmentOptions& options,
                  AlignedPatch* const& result) {
    constexpr int kHalf = kPatchSize / 2;
    const auto max_column = static_cast<float>(image.cols - kHalf);
    const auto max_row = static_cast<float>(image.rows - kHalf);
    float u = start_u;
    float v = start_v;
    Sums sums = {};
    for (int i = 0; i < options.max_iterations; ++i) {
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
      if (!(std::abs(u - start_u) <= options.max_shift_px &&
            std::abs(v - start_v) <= options.max_shift_px)) {
        return;
      }
      if (step_u * step_u + step_v * step_v <
          options.min_step_px * options.min_step_px) {
        break;
      }
    }
    const float energy = sums.squares - sums.grey * sums.grey / Patch::kPixels;
    const float explained = sums.contrast * sums.contrast * patch.energy;
    const float left = std::max(energy - explained, 0.0F) / Patch::kPixels;
    *result = {true,
               u,
               v,
               sums.contrast,
               std::sqrt(explained / (explained + left * Patch::kPixels)),
               std::sqrt(left) / sums.contrast};
  }
};

}  // namespace

AlignedPatch AlignPatch(const Patch& patch, const cv::Mat& image, float start_u,
                        float start_v, const PatchAlignmentOptions& options) {
  AlignedPatch result;
  if (patch.min_eigenvalue > 0.0F) {
    RunVectorised<AlignKernel>(patch, image, start_u, start_v, options,
                               &result);
  }
  return result;
}

}  // namespace rgbd_pose
