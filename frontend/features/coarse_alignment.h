#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/image/frame.h"

namespace rgbd_pose {

// How the grey level that a pixel predicts, gain * grey + bias, changes with
// [rotation (rad), translation (m), gain, bias] at no motion and a gain of 1.
// `place`: what it shows, in camera axes (m); `gradient`: of the image there,
// grey levels per px; `camera`: undistorted.
Eigen::Matrix<float, 8, 1> PhotometricJacobian(const Eigen::Vector3f& place,
                                               float grey,
                                               const Eigen::Vector2f& gradient,
                                               const Camera& camera);

// The coarse levels of a frame's pyramid as points in space, to be found again
// in another frame as a whole: by inverse-compositional Lucas-Kanade over the
// six parameters of the motion and a common gain and bias (their Jacobian does
// not depend on the frame, so all that can be is computed once). Good to a
// pixel or two of the full image, from dozens of pixels away.
class CoarseReference {
 public:
  // `pyramid`: of frame.gray, see image_pyramid.h.
  CoarseReference(const Frame& frame, const std::vector<cv::Mat>& pyramid,
                  const Camera& camera);

  // The motion that shows the reference in the other pyramid, near a guess:
  // the guess itself unless another one explains the images better.
  Rigid3d Align(const std::vector<cv::Mat>& pyramid,
                const Rigid3d& cur_from_ref_guess) const;

 private:
  static constexpr int kParameters = 8;  // motion, gain, bias

  using Parameters = Eigen::Matrix<float, kParameters, 1>;

  // A pixel of a level.
  struct Point {
    Eigen::Vector3f place;       // in camera axes, m
    Eigen::Vector2f distortion;  // by the lens, px
    float grey;
    Parameters step;  // what a grey level of it tells about the parameters
  };

  struct Level {
    int level = 0;
    Camera camera;
    std::vector<Point> points;
    float mean = 0.0F;       // of their grey levels
    float deviation = 0.0F;  // likewise, standard
  };

  // The fit of one level at one motion.
  struct Fit {
    float gain = 1.0F;
    float bias = 0.0F;
    float cost = 0.0F;  // mean squared clamped difference
    Parameters step;
  };

  static Level MakeLevel(const Frame& frame, const cv::Mat& image, int level,
                         const Camera& camera);
  static Fit FitAt(const Level& level, const cv::Mat& image,
                   const Rigid3d& cur_from_ref, float gain, float bias);

  std::vector<Level> levels_;  // coarsest first
};

}  // namespace rgbd_pose
