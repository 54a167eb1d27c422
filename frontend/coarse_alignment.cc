#include "frontend/coarse_alignment.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "frontend/image_pyramid.h"

namespace rgbd_pose {
namespace {

// Levels used: 20 x 15 to 80 x 60 of 640 x 480.
constexpr int kCoarsest = 5;
constexpr int kFinest = 3;
constexpr int kMaxIterations = 6;
constexpr float kMinStepPx = 0.05F;
constexpr float kMinGradient = 1.5F;
constexpr int kMinPoints = 30;

// Differences beyond this (grey levels) are other things than noise and
// interpolation, and count no more than this.
constexpr float kMaxDifference = 15.0F;

// Standard deviations of the motion about the guess, against differences of
// kMaxDifference: keeps what the image does not tell small.
constexpr float kSigmaTurn = 0.1F;   // rad
constexpr float kSigmaShift = 0.1F;  // m

Camera AtLevel(Camera camera, int level) {
  const double scale = 1.0 / (1 << level);
  camera.fx *= scale;
  camera.fy *= scale;
  camera.cx = (camera.cx + 0.5) * scale - 0.5;
  camera.cy = (camera.cy + 0.5) * scale - 0.5;
  return camera;
}

}  // namespace

CoarseReference::CoarseReference(const Frame& frame,
                                 const std::vector<cv::Mat>& pyramid,
                                 const Camera& camera) {
  const int coarsest = std::min(kCoarsest, static_cast<int>(pyramid.size()) - 1);
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
  using Row = Eigen::Matrix<float, kParameters, 1>;
  Level level;
  level.level = index;
  level.camera = AtLevel(camera, index);
  const Camera& c = level.camera;
  std::vector<Row> rows;
  double sum = 0.0, squares = 0.0;
  for (int v = 1; v + 1 < image.rows; ++v) {
    const uint8_t* row = image.ptr<uint8_t>(v);
    for (int u = 1; u + 1 < image.cols; ++u) {
      const float gx = 0.5F * static_cast<float>(row[u + 1] - row[u - 1]);
      const float gy = 0.5F * static_cast<float>(row[u + image.step] -
                                                 row[u - image.step]);
      if (std::abs(gx) + std::abs(gy) < kMinGradient) continue;
      const double depth =
          frame.DepthAt(static_cast<int>(FromLevel(u, index)),
                        static_cast<int>(FromLevel(v, index)));
      if (depth <= 0.0) continue;
      const Eigen::Vector3f X =
          c.Unproject(Eigen::Vector2d(u, v), depth).cast<float>();
      const float a = gx * static_cast<float>(c.fx) / X.z();
      const float b = gy * static_cast<float>(c.fy) / X.z();
      const float d = -(a * X.x() + b * X.y()) / X.z();
      Row jacobian;
      const float grey = row[u];
      jacobian << X.y() * d - X.z() * b, X.z() * a - X.x() * d,
          X.x() * b - X.y() * a, a, b, d, grey, 1.0F;
      rows.push_back(jacobian);
      level.points.push_back(X);
      level.grey.push_back(grey);
      sum += grey;
      squares += grey * grey;
    }
  }
  const size_t n = rows.size();
  if (static_cast<int>(n) < kMinPoints) return level;
  level.mean = static_cast<float>(sum / n);
  level.deviation =
      std::sqrt(std::max(0.0, squares / n - level.mean * level.mean));
  Eigen::Matrix<double, kParameters, kParameters> information;
  information.setZero();
  for (const Row& row : rows) {
    const Eigen::Matrix<double, kParameters, 1> r = row.cast<double>();
    information += r * r.transpose();
  }
  const double noise = kMaxDifference * kMaxDifference;
  for (int i = 0; i < 3; ++i) {
    information(i, i) += noise / (kSigmaTurn * kSigmaTurn);
    information(i + 3, i + 3) += noise / (kSigmaShift * kSigmaShift);
  }
  const Eigen::Matrix<float, kParameters, kParameters> inverse =
      information.inverse().cast<float>();
  level.steps.reserve(n);
  for (const Row& row : rows) level.steps.push_back(inverse * row);
  return level;
}

void CoarseReference::StartingGain(const Level& level, const cv::Mat& image,
                                   float* gain, float* bias) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  *gain = 1.0F;
  if (level.deviation > 1.0F && deviation[0] > 1.0) {
    *gain = static_cast<float>(deviation[0]) / level.deviation;
  }
  *bias = static_cast<float>(mean[0]) - *gain * level.mean;
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
  const float fx = c.fx, fy = c.fy, cx = c.cx, cy = c.cy;
  const bool distorted = c.HasDistortion();
  const float clamp = kMaxDifference * gain;
  for (size_t i = 0; i < level.points.size(); ++i) {
    const Eigen::Vector3f X = R * level.points[i] + t;
    const float predicted = gain * level.grey[i] + bias;
    float difference = clamp;
    float seen = predicted;
    if (X.z() > 0.1F) {
      float u, v;
      if (distorted) {
        const Eigen::Vector2d pixel = c.Project(X.cast<double>());
        u = static_cast<float>(pixel.x());
        v = static_cast<float>(pixel.y());
      } else {
        const float inverse = 1.0F / X.z();
        u = fx * X.x() * inverse + cx;
        v = fy * X.y() * inverse + cy;
      }
      if (u >= 0.0F && v >= 0.0F && u < image.cols - 1 && v < image.rows - 1) {
        const int column = static_cast<int>(u);
        const int row = static_cast<int>(v);
        const float s = u - column;
        const float q = v - row;
        const uint8_t* p = image.ptr<uint8_t>(row) + column;
        const float above = p[0] + s * (p[1] - p[0]);
        p += image.step;
        const float below = p[0] + s * (p[1] - p[0]);
        difference = above + q * (below - above) - predicted;
        difference = std::clamp(difference, -clamp, clamp);
        seen = predicted + difference;
      }
    }
    fit.cost += difference * difference;
    fit.step += seen * level.steps[i];
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
  float gain = 1.0F;
  float bias = 0.0F;
  StartingGain(levels_.front(), pyramid[levels_.front().level], &gain, &bias);
  for (const Level& level : levels_) {
    for (int i = 0; i < kMaxIterations; ++i) {
      const Fit fit =
          FitAt(level, pyramid[level.level], cur_from_ref, gain, bias);
      if (!(fit.gain > 0.1F && fit.gain < 10.0F)) return cur_from_ref_guess;
      gain = fit.gain;
      bias = fit.bias;
      const Eigen::Matrix<double, 6, 1> step =
          -(fit.step.head<6>() / gain).cast<double>();
      const Eigen::Vector3d turn = step.head<3>();
      const double angle = turn.norm();
      cur_from_ref =
          cur_from_ref *
          Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(
                      angle, angle > 0.0 ? Eigen::Vector3d(turn / angle)
                                         : Eigen::Vector3d::UnitX())),
                  step.tail<3>());
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
