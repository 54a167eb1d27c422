#include "apps/results/inertial_output.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace rgbd_pose {
namespace {

TEST(GravityOutputTest, SaysWhatIsUpAndHowWell) {
  GravityEstimate gravity;
  gravity.up = {0.6, -0.8, 0.0};
  gravity.sigma = 0.01;
  gravity.bias_covariance.diagonal() << 0.04, 0.01, 0.09;
  gravity.means = 12;
  const nlohmann::json json = GravityToJson(gravity);
  EXPECT_NEAR(json.at("sigma_deg").get<double>(), 0.573, 1e-3);
  EXPECT_NEAR(json.at("accel_bias_sigma")[2].get<double>(), 0.3, 1e-12);
  EXPECT_EQ(FormatGravity(json),
            "gravity     up is (0.6000 -0.8000 0.0000) in the world, sigma "
            "0.57 degrees\n");
}

TEST(GravityOutputTest, SaysWhyItIsNotKnown) {
  GravityEstimate gravity;
  gravity.refusal = "the camera fell";
  const nlohmann::json json = GravityToJson(gravity);
  EXPECT_EQ(json.count("up"), 0);
  EXPECT_EQ(FormatGravity(json),
            "gravity     not determined: the camera fell\n");
}

TEST(GyroscopeOutputTest, SaysWhatWasLearnt) {
  ImuSensor sensor;
  sensor.calibration.cam_from_imu = Rigid3d();
  sensor.calibration.delay_s = 0.012;
  const nlohmann::json json = GyroscopeToJson(CameraImu(sensor));
  EXPECT_NEAR(json.at("delay_ms").get<double>(), 12.0, 1e-9);
  EXPECT_NEAR(json.at("bias_sigma")[1].get<double>(), CameraImu::kBiasSigma,
              1e-12);
  EXPECT_EQ(json.at("turns"), 0);
  EXPECT_EQ(FormatGyroscope(json),
            "gyroscope   not used: there are no samples at the time of the "
            "frames; do both use the same clock?\n");
  nlohmann::json sure = json;
  sure["doubt"] = "";
  EXPECT_EQ(FormatGyroscope(sure),
            "gyroscope   delay 12.0 ms, sigma 10; mounting off by 0.00 "
            "degrees, sigma 2.9\n");
}

}  // namespace
}  // namespace rgbd_pose
