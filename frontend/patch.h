#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace rgbd_pose {

// What inverse-compositional Lucas-Kanade (Baker & Matthews 2004) needs to know
// of a patch of N x N pixels T, rows after each other. An image patch I that
// shows it brighter and moved by d px, I = gain T(x + d) + bias, has
//   gain = <contrast, I>,   d = (<steps_x, I>, <steps_y, I>) / gain
// to first order: gain and bias are solved for along with d, and as the steps
// are orthogonal to T and to 1, they need no iteration of their own.
template <int N>
struct Patch {
  static constexpr int kSize = N;

  alignas(64) float contrast[N * N];
  alignas(64) float steps_x[N * N];
  alignas(64) float steps_y[N * N];

  // Sum of squared deviations of T from its mean.
  float energy = 0.0F;

  // The smaller eigenvalue of the Hessian of d (grey^2 / px^2): a noise of s
  // grey levels moves the result by s / sqrt(of this) px.
  float min_eigenvalue = 0.0F;

  // False if there is too little to hold on to.
  bool IsUsable() const { return min_eigenvalue > 0.0F; }
};

// The patch around a point (px of `image`, CV_8UC1), seen through an affine
// map: pixel (i, j) of it, -N / 2 <= i, j < N / 2, shows
// image(centre + image_from_patch * (i, j)). Beyond its border the image goes
// on as there.
template <int N>
void MakePatch(const cv::Mat& image, const Eigen::Vector2f& centre,
               const Eigen::Matrix2f& image_from_patch, Patch<N>* patch);

}  // namespace rgbd_pose
