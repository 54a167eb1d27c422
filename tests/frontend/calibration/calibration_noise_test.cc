// Fits the depth noise model to simulated depths with known noise.

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/depth_noise.h"
#include "frontend/calibration/calibration_result.h"

namespace rgbd_pose {
namespace {

constexpr int kNoisyKeyframes = 6;

// Landmarks on walls that face the camera, seen from poses next to each other.
// Each depth is the mean of 3 x 3 pixels, whose errors are independent or
// equal. `percent_wrong` of the depths are outliers.
struct NoisyScene {
  CalibrationViews views;
  CalibrationState state;

  NoisyScene(const DepthNoiseModel& noise, bool err_alike, int percent_wrong,
             double far = 4.0, int landmarks = 2000) {
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(generator);
    };
    const Camera& camera = views.camera;
    for (int k = 0; k < kNoisyKeyframes; ++k) {
      Rigid3d pose;
      pose.translation.x() = 0.02 * k;
      views.world_from_cam.push_back(pose);
      views.twists.emplace_back();
    }
    state.world_from_cam = views.world_from_cam;
    state.theta.setZero();
    state.theta.head<4>() << camera.fx, camera.fy, camera.cx, camera.cy;
    state.theta[kDepthFactor] = 1.0;
    for (int i = 0; i < landmarks; ++i) {
      const double z = uniform(0.7, far);
      Landmark landmark;
      landmark.u = uniform(200.0, 400.0);
      landmark.v = uniform(100.0, 300.0);
      landmark.first_view = static_cast<int>(views.views.size());
      landmark.num_views = kNoisyKeyframes - 1;
      double sum = 0.0;
      const auto measure = [&](double u, double v) {
        MeasuredInverseDepth depth;
        double pixel = 0.0, mean = 0.0;
        for (int n = 0; n < 9; ++n) {
          if (n == 0 || !err_alike) pixel = normal(generator);
          mean += pixel / 9.0;
        }
        if (uniform(0.0, 100.0) < percent_wrong) pixel = mean = 100.0;
        depth.value = 1.0 / (z + noise.sigma(z) * mean);
        depth.pixel_value = 1.0 / (z + noise.sigma(z) * pixel);
        depth.plane = Eigen::Vector3d::UnitZ();
        depth.ray = depth.pixel_ray = camera.Ray(u, v);
        depth.inverse_sigma = z * z / noise.sigma(z);
        sum += std::abs(pixel) < 50.0 ? depth.value : 1.0 / z;
        return depth;
      };
      landmark.depth = measure(landmark.u, landmark.v);
      for (int k = 1; k < kNoisyKeyframes; ++k) {
        LandmarkView view;
        view.keyframe = k;
        view.u = landmark.u - camera.fx * 0.02 * k / z;
        view.v = landmark.v;
        view.sigma_px = 1e3;  // only depth constrains the position
        view.depth = measure(view.u, view.v);
        views.views.push_back(view);
      }
      views.landmarks.push_back(landmark);
      state.inverse_depths.push_back(sum / kNoisyKeyframes);
    }
  }

  std::optional<DepthNoiseFit> Fit() const {
    return FitDepthNoise(views, state,
                         *FindNamed(DepthNoiseModels(), "khoshelham"));
  }
};

TEST(DepthNoiseFitTest, FindsBothParts) {
  for (const int percent_wrong : {0, 5}) {
    const NoisyScene scene({"", 2e-3, 2e-3}, false, percent_wrong);
    const auto fit = scene.Fit();
    ASSERT_TRUE(fit.has_value());
    EXPECT_NEAR(fit->model.constant, 2e-3, 2e-4) << percent_wrong;
    EXPECT_NEAR(fit->model.quadratic, 2e-3, 2e-4) << percent_wrong;
    EXPECT_LT(fit->constant_sigma, 2e-4);
    EXPECT_LT(fit->quadratic_sigma, 1e-4);
    EXPECT_EQ(fit->model.Check(), "");
  }
}

TEST(DepthNoiseFitTest, WhatIsNotThereIsNone) {
  const auto kinect = NoisyScene({"", 0.0, 2.85e-3}, false, 0).Fit();
  ASSERT_TRUE(kinect.has_value());
  EXPECT_EQ(kinect->model.constant, 0.0);
  EXPECT_NEAR(kinect->model.quadratic, 2.85e-3, 1e-4);
  EXPECT_NEAR(kinect->in_old_sigmas, 2.0, 0.05);
  const auto constant = NoisyScene({"", 5e-3, 0.0}, false, 0).Fit();
  ASSERT_TRUE(constant.has_value());
  EXPECT_NEAR(constant->model.constant, 5e-3, 2e-4);
  EXPECT_EQ(constant->model.quadratic, 0.0);
}

TEST(DepthNoiseFitTest, TellsWhetherNeighboursErrAlike) {
  const DepthNoiseModel noise = {"", 0.0, 2e-3};
  const auto apart = NoisyScene(noise, false, 0).Fit();
  const auto alike = NoisyScene(noise, true, 0).Fit();
  ASSERT_TRUE(apart.has_value() && alike.has_value());
  EXPECT_NEAR(apart->model.mean_share, 1.0 / 3.0, 0.03);
  EXPECT_GT(alike->model.mean_share, 0.9);
  // The landmarks are fitted to the depths, which reduces the scatter.
  EXPECT_NEAR(alike->model.quadratic, 2e-3, 1e-4);
}

TEST(DepthNoiseFitTest, FewDepthsTellNothing) {
  EXPECT_FALSE(
      NoisyScene({"", 0.0, 2e-3}, false, 0, 4.0, 40).Fit().has_value());
}

}  // namespace
}  // namespace rgbd_pose
