#include "frontend/features/coarse_alignment.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "frontend/image/image_pyramid.h"
#include "frontend/image/sample_image.h"

namespace rgbd_pose {
namespace {

// Levels used: 20 x 15 to 80 x 60 of 640 x 480.
constexpr int kCoarsest = 5;
constexpr int kFinest = 3;
constexpr int kMaxIterations = 6;

// A step shorter than this (px of its level) is the last of a level.
constexpr float kMinStepPx = 0.05F;

// Flatter pixels (grey levels per px) are noise.
constexpr float kMinGradient = 1.5F;

// Several for each parameter.
constexpr int kMinPoints = 30;

// A gain beyond these is not one of exposure: nothing fits.
constexpr float kMinGain = 0.1F;
constexpr float kMaxGain = 10.0F;

// Differences beyond this (grey levels) are other things than noise and
// interpolation, and count no more than this.
constexpr float kMaxDifference = 15.0F;

// Standard deviations of the motion about the guess, against differences of
// kMaxDifference: keeps what the image does not tell small.
constexpr float kSigmaTurn = 0.1F;   // rad
constexpr float kSigmaShift = 0.1F;  // m

constexpr float kMinDepth = 0.1F;  // m, before the camera

// The rotation by a vector, good for steps.
Eigen::Quaterniond SmallTurn(const Eigen::Vector3d& turn) {
  return Eigen::Quaterniond(1.0, 0.5 * turn.x(), 0.5 * turn.y(),
                            0.5 * turn.z());
}

}  // namespace

Eigen::Matrix<float, 8, 1> PhotometricJacobian(const Eigen::Vector3f& place,
                                               float grey,
                                               const Eigen::Vector2f& gradient,
                                               const Camera& camera) {
  const Eigen::Vector3f& X = place;
  const float a = gradient.x() * static_cast<float>(camera.fx) / X.z();
  const float b = gradient.y() * static_cast<float>(camera.fy) / X.z();
  const float d = -(a * X.x() + b * X.y()) / X.z();
  Eigen::Matrix<float, 8, 1> row;
  row << X.y() * d - X.z() * b, X.z() * a - X.x() * d, X.x() * b - X.y() * a, a,
      b, d, grey, 1.0F;
  return row;
}

CoarseReference::CoarseReference(const Frame& frame,
                                 const std::vector<cv::Mat>& pyramid,
                                 const Camera& camera) {
  const int coarsest =
      std::min(kCoarsest, static_cast<int>(pyramid.size()) - 1);
  for (int level = coarsest; level >= kFinest; --level) {
    Level made = MakeLevel(frame, pyramid[level], level, camera);
    if (static_cast<int>(made.points.size()) >= kMinPoints) {
      levels_.push_back(std::move(made));
    }
  }
}

CoarseReference::Level CoarseReference::MakeLevel(const Frame& frame,
                                                  const cv::Mat& image,
                                                  int index,
                                                  const Camera& camera) {
  Level level;
  level.level = index;
  level.camera = CameraOfLevel(camera, index);
  const Camera& c = level.camera;
  double sum = 0.0, squares = 0.0;
  for (int v = 1; v + 1 < image.rows; ++v) {
    const uint8_t* above = image.ptr<uint8_t>(v - 1);
    const uint8_t* row = image.ptr<uint8_t>(v);
    const uint8_t* below = image.ptr<uint8_t>(v + 1);
    for (int u = 1; u + 1 < image.cols; ++u) {
      const float gx = 0.5F * static_cast<float>(row[u + 1] - row[u - 1]);
      const float gy = 0.5F * static_cast<float>(below[u] - above[u]);
      if (std::abs(gx) + std::abs(gy) < kMinGradient) continue;
      const double depth = frame.DepthAt(static_cast<int>(FromLevel(u, index)),
                                         static_cast<int>(FromLevel(v, index)));
      if (depth <= 0.0) continue;
      const Eigen::Vector2d ideal = c.Undistort(Eigen::Vector2d(u, v));
      Point point;
      point.distortion = (Eigen::Vector2d(u, v) - ideal).cast<float>();
      point.place = (c.Ray(ideal.x(), ideal.y()) * depth).cast<float>();
      point.grey = row[u];
      point.step = PhotometricJacobian(point.place, point.grey, {gx, gy}, c);
      level.points.push_back(point);
      sum += point.grey;
      squares += point.grey * point.grey;
    }
  }
  const size_t n = level.points.size();
  if (static_cast<int>(n) < kMinPoints) return level;
  level.mean = static_cast<float>(sum / n);
  level.deviation =
      std::sqrt(std::max(0.0, squares / n - level.mean * level.mean));
  Eigen::Matrix<double, kParameters, kParameters> information;
  information.setZero();
  for (const Point& point : level.points) {
    const Eigen::Matrix<double, kParameters, 1> row = point.step.cast<double>();
    information += row * row.transpose();
  }
  const double noise = kMaxDifference * kMaxDifference;
  for (int i = 0; i < 3; ++i) {
    information(i, i) += noise / (kSigmaTurn * kSigmaTurn);
    information(i + 3, i + 3) += noise / (kSigmaShift * kSigmaShift);
  }
  const Eigen::Matrix<float, kParameters, kParameters> inverse =
      information.inverse().cast<float>();
  for (Point& point : level.points) point.step = (inverse * point.step).eval();
  return level;
}

CoarseReference::Fit CoarseReference::FitAt(const Level& level,
                                            const cv::Mat& image,
                                            const Rigid3d& cur_from_ref,
                                            float gain, float bias) {
  Fit fit;
  fit.step.setZero();
  const Eigen::Matrix3f R =
      cur_from_ref.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = cur_from_ref.translation.cast<float>();
  const Camera& c = level.camera;
  const auto fx = static_cast<float>(c.fx);
  const auto fy = static_cast<float>(c.fy);
  const auto cx = static_cast<float>(c.cx);
  const auto cy = static_cast<float>(c.cy);
  const auto max_u = static_cast<float>(image.cols - 1);
  const auto max_v = static_cast<float>(image.rows - 1);
  const float clamp = kMaxDifference * gain;
  for (const Point& point : level.points) {
    const Eigen::Vector3f X = R * point.place + t;
    const float predicted = gain * point.grey + bias;
    // Out of view it says nothing about the motion, but does not explain the
    // image either.
    float cost = clamp;
    float difference = 0.0F;
    const float u = fx * X.x() / X.z() + cx + point.distortion.x();
    const float v = fy * X.y() / X.z() + cy + point.distortion.y();
    if (X.z() > kMinDepth && u >= 0.0F && v >= 0.0F && u < max_u && v < max_v) {
      difference =
          std::clamp(SampleImage(image, u, v) - predicted, -clamp, clamp);
      cost = difference;
    }
    fit.cost += cost * cost;
    fit.step += (predicted + difference) * point.step;
  }
  fit.gain = fit.step[6];
  fit.bias = fit.step[7];
  fit.cost /= gain * gain * static_cast<float>(level.points.size());
  return fit;
}

Rigid3d CoarseReference::Align(const std::vector<cv::Mat>& pyramid,
                               const Rigid3d& cur_from_ref_guess) const {
  if (levels_.empty() ||
      levels_.front().level >= static_cast<int>(pyramid.size())) {
    return cur_from_ref_guess;
  }
  Rigid3d cur_from_ref = cur_from_ref_guess;
  // To start with, the brightness of the whole images.
  const Level& coarsest = levels_.front();
  cv::Scalar mean, deviation;
  cv::meanStdDev(pyramid[coarsest.level], mean, deviation);
  float gain = static_cast<float>(deviation[0]) / coarsest.deviation;
  float bias = static_cast<float>(mean[0]) - gain * coarsest.mean;
  if (!(gain > kMinGain && gain < kMaxGain)) return cur_from_ref_guess;
  for (const Level& level : levels_) {
    for (int i = 0; i < kMaxIterations; ++i) {
      const Fit fit =
          FitAt(level, pyramid[level.level], cur_from_ref, gain, bias);
      if (!(fit.gain > kMinGain && fit.gain < kMaxGain))
        return cur_from_ref_guess;
      gain = fit.gain;
      bias = fit.bias;
      const Eigen::Matrix<double, 6, 1> step =
          -(fit.step.head<6>() / gain).cast<double>();
      cur_from_ref =
          cur_from_ref * Rigid3d(SmallTurn(step.head<3>()), step.tail<3>());
      if (level.camera.fx * step.norm() < kMinStepPx) break;
    }
  }
  const Level& finest = levels_.back();
  const cv::Mat& image = pyramid[finest.level];
  const float before =
      FitAt(finest, image, cur_from_ref_guess, gain, bias).cost;
  const float after = FitAt(finest, image, cur_from_ref, gain, bias).cost;
  return after < before ? cur_from_ref : cur_from_ref_guess;
}

}  // namespace rgbd_pose
