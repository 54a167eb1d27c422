#include "frontend/patch_alignment.h"

#include <cmath>
#include <cstring>

#include "core/vector_lanes.h"

namespace rgbd_pose {
namespace {

// Below this share of the patch's contrast there is nothing like it.
constexpr float kMinGain = 0.1F;

// The sums over an image patch that a step takes.
struct Sums {
  float x, y;           // with the patch's steps
  float contrast;       // with the patch's contrast
  float grey, squares;  // of the grey levels
};

template <int L>
struct FloatLanes {
  typedef float Type __attribute__((vector_size(L * sizeof(float))));
  typedef uint8_t Bytes __attribute__((vector_size(L)));
};

template <int L>
float Total(const typename FloatLanes<L>::Type& lanes) {
  float sum = 0.0F;
  for (int i = 0; i < L; ++i) sum += lanes[i];
  return sum;
}

// The patch whose upper left pixel is `corner`, moved by s and t (0..1) to the
// right and down, against `patch`.
template <int W, int N>
void SumUp(const Patch<N>& patch, const uint8_t* corner, size_t stride, float s,
           float t, Sums* sums) {
  constexpr int kLanes = 2 * W < N ? 2 * W : N;
  using Floats = typename FloatLanes<kLanes>::Type;
  using Bytes = typename FloatLanes<kLanes>::Bytes;
  Floats x{}, y{}, contrast{}, grey{}, squares{};
  for (int j = 0; j < N; j += kLanes) {
    Floats above{};
    for (int i = 0; i <= N; ++i) {
      Bytes left, right;
      std::memcpy(&left, corner + i * stride + j, sizeof(left));
      std::memcpy(&right, corner + i * stride + j + 1, sizeof(right));
      const Floats l = __builtin_convertvector(left, Floats);
      const Floats r = __builtin_convertvector(right, Floats);
      const Floats row = l + s * (r - l);
      if (i > 0) {
        const Floats value = above + t * (row - above);
        const int k = (i - 1) * N + j;
        Floats a, b, c;
        std::memcpy(&a, patch.steps_x + k, sizeof(a));
        std::memcpy(&b, patch.steps_y + k, sizeof(b));
        std::memcpy(&c, patch.contrast + k, sizeof(c));
        x += a * value;
        y += b * value;
        contrast += c * value;
        grey += value;
        squares += value * value;
      }
      above = row;
    }
  }
  *sums = {Total<kLanes>(x), Total<kLanes>(y), Total<kLanes>(contrast),
           Total<kLanes>(grey), Total<kLanes>(squares)};
}

template <int N>
struct AlignKernel {
  template <int W>
  static void Run(const Patch<N>& patch, const cv::Mat& image, float start_u,
                  float start_v, const PatchAlignmentOptions& options,
                  AlignedPatch* const& result) {
    float u = start_u;
    float v = start_v;
    for (int i = 0; i < options.max_iterations; ++i) {
      const float left = std::floor(u);
      const float top = std::floor(v);
      if (!(left >= N / 2 && top >= N / 2 &&
            left <= static_cast<float>(image.cols - N / 2 - 1) &&
            top <= static_cast<float>(image.rows - N / 2 - 1))) {
        return;
      }
      const int column = static_cast<int>(left) - N / 2;
      const int row = static_cast<int>(top) - N / 2;
      Sums sums;
      SumUp<W>(patch, image.ptr<uint8_t>(row) + column, image.step, u - left,
               v - top, &sums);
      const float gain = sums.contrast;
      if (!(gain > kMinGain)) return;
      const float step_u = sums.x / gain;
      const float step_v = sums.y / gain;
      u -= step_u;
      v -= step_v;
      if (!(std::abs(u - start_u) <= options.max_shift_px &&
            std::abs(v - start_v) <= options.max_shift_px)) {
        return;
      }
      const bool last =
          step_u * step_u + step_v * step_v <=
          options.min_step_px * options.min_step_px;
      if (!last && i + 1 < options.max_iterations) continue;
      const float energy = sums.squares - sums.grey * sums.grey / (N * N);
      const float explained = gain * gain * patch.energy;
      result->found = true;
      result->u = u;
      result->v = v;
      result->gain = gain;
      result->correlation = std::sqrt(explained / energy);
      result->residual =
          std::sqrt(std::max(energy - explained, 0.0F) / (N * N)) / gain;
      return;
    }
  }
};

}  // namespace

template <int N>
AlignedPatch AlignPatch(const Patch<N>& patch, const cv::Mat& image,
                        float start_u, float start_v,
                        const PatchAlignmentOptions& options) {
  AlignedPatch result;
  if (patch.IsUsable()) {
    RunVectorised<AlignKernel<N>>(patch, image, start_u, start_v, options,
                                  &result);
  }
  return result;
}

template AlignedPatch AlignPatch(const Patch<8>&, const cv::Mat&, float, float,
                                 const PatchAlignmentOptions&);
template AlignedPatch AlignPatch(const Patch<16>&, const cv::Mat&, float, float,
                                 const PatchAlignmentOptions&);

}  // namespace rgbd_pose
