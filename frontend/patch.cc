#include "frontend/patch.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

// A gradient below this (grey levels per px, mean over the patch) is noise.
static const float kMinGradient = getenv("T_GRAD") ? atof(getenv("T_GRAD")) : 1.0F;

// An image point, bilinear; coordinates are clamped to the image.
float Sample(const cv::Mat& image, float u, float v) {
  u = std::clamp(u, 0.0F, static_cast<float>(image.cols - 1));
  v = std::clamp(v, 0.0F, static_cast<float>(image.rows - 1));
  const int column = std::min(static_cast<int>(u), image.cols - 2);
  const int row = std::min(static_cast<int>(v), image.rows - 2);
  const float s = u - static_cast<float>(column);
  const float t = v - static_cast<float>(row);
  const uint8_t* upper = image.ptr<uint8_t>(row) + column;
  const uint8_t* lower = upper + image.step;
  const float above = upper[0] + s * static_cast<float>(upper[1] - upper[0]);
  const float below = lower[0] + s * static_cast<float>(lower[1] - lower[0]);
  return above + t * (below - above);
}

}  // namespace

template <int N>
void MakePatch(const cv::Mat& image, const Eigen::Vector2f& centre,
               const Eigen::Matrix2f& image_from_patch, Patch<N>* patch) {
  using Pixels = Eigen::Array<float, N, N, Eigen::RowMajor>;
  // One more on each side for the derivatives.
  Eigen::Array<float, N + 2, N + 2, Eigen::RowMajor> seen;
  for (int i = 0; i < N + 2; ++i) {
    for (int j = 0; j < N + 2; ++j) {
      const Eigen::Vector2f offset(j - 1 - N / 2, i - 1 - N / 2);
      const Eigen::Vector2f at = centre + image_from_patch * offset;
      seen(i, j) = Sample(image, at.x(), at.y());
    }
  }
  Pixels grey = seen.template block<N, N>(1, 1);
  Pixels x = 0.5F * (seen.template block<N, N>(1, 2) -
                     seen.template block<N, N>(1, 0));
  Pixels y = 0.5F * (seen.template block<N, N>(2, 1) -
                     seen.template block<N, N>(0, 1));
  grey -= grey.mean();
  patch->energy = grey.square().sum();
  patch->min_eigenvalue = 0.0F;
  if (patch->energy < kMinGradient * kMinGradient * N * N) return;
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
  if (!(smaller > kMinGradient * kMinGradient * N * N)) return;
  patch->min_eigenvalue = smaller;
  Eigen::Map<Pixels>(patch->contrast) = contrast;
  Eigen::Map<Pixels>(patch->steps_x) = (yy * x - xy * y) / determinant;
  Eigen::Map<Pixels>(patch->steps_y) = (xx * y - xy * x) / determinant;
}

template void MakePatch(const cv::Mat&, const Eigen::Vector2f&,
                        const Eigen::Matrix2f&, Patch<8>*);
template void MakePatch(const cv::Mat&, const Eigen::Vector2f&,
                        const Eigen::Matrix2f&, Patch<16>*);

}  // namespace rgbd_pose
