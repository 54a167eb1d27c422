#include "frontend/files/imu_calibration_file.h"

#include <gtest/gtest.h>

#include <string>

#include "frontend/files/camera_file.h"
#include "tests/support/camera_file_samples.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

constexpr char kNoise[] =
    "accelerometer_noise_density: 0.006\n"
    "accelerometer_random_walk: 0.0002\n"
    "gyroscope_noise_density: 0.0004\n"
    "gyroscope_random_walk: 4.0e-06\n"
    "rostopic: /imu0\n"
    "update_rate: 200.0\n";

constexpr char kMatrix[] =
    "[[0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]]\n";

class ImuCalibrationFileTest : public testing::Test {
 protected:
  ImuCalibration Read(const std::string& text) {
    return ReadImuCalibrationFile(folder_.Write("imu.yaml", text));
  }
  static void ExpectMounting(const ImuCalibration& known) {
    ASSERT_TRUE(known.cam_from_imu.has_value());
    EXPECT_TRUE((*known.cam_from_imu * Eigen::Vector3d(1, 0, 0))
                    .isApprox(Eigen::Vector3d(0.1, 1.2, 0.3), 1e-12));
  }

  TempFolder folder_;
};

TEST_F(ImuCalibrationFileTest, ReadsTheNoiseThatKalibrIsGiven) {
  const ImuCalibration known = Read(kNoise);
  ASSERT_TRUE(known.noise.has_value());
  EXPECT_EQ(known.noise->accel_density, 0.006);
  EXPECT_EQ(known.noise->accel_walk, 0.0002);
  EXPECT_EQ(known.noise->gyro_density, 0.0004);
  EXPECT_EQ(known.noise->gyro_walk, 4e-6);
  EXPECT_FALSE(known.cam_from_imu.has_value());
  EXPECT_FALSE(known.delay_s.has_value());
}

// As Kalibr writes it, with all keys below imu0.
TEST_F(ImuCalibrationFileTest, ReadsTheNoiseThatKalibrWrites) {
  std::string text = kNoise;
  for (size_t at = 0; at < text.size(); at = text.find('\n', at) + 1) {
    text.insert(at, "  ");
  }
  EXPECT_EQ(Read("imu0:\n  T_i_b:\n  - [1.0, 0.0, 0.0, 0.0]\n  model: "
                 "calibrated\n  time_offset: 0.0\n" +
                 text)
                .noise->gyro_density,
            0.0004);
}

// T_cam_imu and timeshift_cam_imu of Kalibr's camchain-imucam, whose other
// cameras do not count.
TEST_F(ImuCalibrationFileTest, ReadsMountingAndDelayOfTheColourCamera) {
  const std::string chain =
      "cam0:\n"
      "  T_cam_imu: " +
      std::string(kMatrix) +
      "  cam_overlaps: [1]\n"
      "  camera_model: pinhole\n"
      "  distortion_coeffs: [0.01, 0.02, 0.03, 0.04]\n"
      "  distortion_model: radtan\n"
      "  intrinsics: [600.5, 601.5, 424.25, 240.75]\n"
      "  resolution: [848, 480]\n"
      "  timeshift_cam_imu: -0.0125\n"
      "cam1:\n"
      "  T_cam_imu: [1]\n"
      "  timeshift_cam_imu: 0.5\n";
  const ImuCalibration alone = Read(chain);
  ExpectMounting(alone);
  EXPECT_EQ(alone.delay_s, -0.0125);
  const CameraSetup camera =
      ReadCameraFile(folder_.Write("camera.yaml", chain), "cam0");
  ExpectMounting(camera.imu);
  EXPECT_EQ(camera.imu.delay_s, -0.0125);
  EXPECT_EQ(camera.remark, "");
}

TEST_F(ImuCalibrationFileTest, ReadsTheInverseThatOpenVinsHas) {
  const std::string inverse =
      "[[0, 1, 0, -0.2], [-1, 0, 0, 0.1], [0, 0, 1, -0.3], [0, 0, 0, 1]]\n";
  ExpectMounting(Read("cam0:\n  T_imu_cam: " + inverse));
}

// Settings of ORB-SLAM3 have the camera in the axes of the sensor.
TEST_F(ImuCalibrationFileTest, ReadsTheSettingsOfOrbSlam3) {
  for (const std::string key : {"IMU.T_b_c1", "Tbc"}) {
    const std::string text =
        kOrbSlam3 + key +
        ": !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: f\n"
        "   data: [0, 1, 0, -0.2,\n          -1, 0, 0, 0.1,\n"
        "          0, 0, 1, -0.3,\n          0, 0, 0, 1]\n"
        "IMU.InsertKFsWhenLost: 0\n"
        "IMU.NoiseGyro: 1e-3 # rad/s^0.5\n"
        "IMU.NoiseAcc: 1e-2\n"
        "IMU.GyroWalk: 1e-6\n"
        "IMU.AccWalk: 1e-4\n"
        "IMU.Frequency: 200.0\n";
    const CameraSetup camera =
        ReadCameraFile(folder_.Write("camera.yaml", text), "cam0");
    EXPECT_EQ(camera.remark, "");
    for (const ImuCalibration& known : {camera.imu, Read(text)}) {
      ExpectMounting(known);
      ASSERT_TRUE(known.noise.has_value());
      EXPECT_EQ(known.noise->gyro_density, 1e-3);
      EXPECT_EQ(known.noise->accel_density, 1e-2);
      EXPECT_EQ(known.noise->gyro_walk, 1e-6);
      EXPECT_EQ(known.noise->accel_walk, 1e-4);
    }
  }
}

TEST_F(ImuCalibrationFileTest, MistakesInSettingsOfOrbSlam3AreSaid) {
  const std::string path = folder_.Write("imu.yaml", "IMU.NoiseGiro: 1e-3\n");
  ExpectInputError([&] { ReadImuCalibrationFile(path); },
                   {path + ":1: IMU.NoiseGiro", "did you mean IMU.NoiseGyro?"});
  const std::string no_walk =
      folder_.Write("walk.yaml", "IMU.NoiseGyro: 1e-3\nIMU.NoiseAcc: 0.01\n");
  ExpectInputError([&] { ReadImuCalibrationFile(no_walk); },
                   {no_walk, "IMU.GyroWalk"});
}

TEST_F(ImuCalibrationFileTest, CameraFilesOfEveryLayoutMayHaveTheKeys) {
  for (const char* layout : {kOrbSlam2, kOrbSlam3, kRos, kKalibr}) {
    const CameraSetup camera = ReadCameraFile(
        folder_.Write("camera.yaml", layout + std::string(kNoise) +
                                         "T_cam_imu: " + kMatrix +
                                         "timeshift_cam_imu: 0.005\n"),
        "cam0");
    ExpectMounting(camera.imu);
    EXPECT_EQ(camera.imu.delay_s, 0.005);
    EXPECT_EQ(camera.imu.noise->accel_walk, 0.0002);
    EXPECT_EQ(camera.remark, "");
    EXPECT_TRUE(ReadCameraFile(folder_.Write("plain.yaml", layout), "cam0")
                    .imu.IsEmpty());
  }
}

TEST_F(ImuCalibrationFileTest, ReadsWhatItWrites) {
  ImuCalibration calibration;
  calibration.cam_from_imu =
      Rigid3d::FromRotationVector({0.1, -0.2, 0.3}, {0.01, 0.02, -0.03});
  calibration.delay_s = -1.0 / 300.0;
  calibration.noise = ImuNoise{1e-3, 2e-2, 3e-5, 4e-4};
  const ImuCalibration read = Read(FormatImuCalibration(calibration));
  EXPECT_EQ(read.delay_s, calibration.delay_s);
  EXPECT_EQ(read.noise->accel_walk, 4e-4);
  const Rigid3d off = read.cam_from_imu->Inverse() * *calibration.cam_from_imu;
  constexpr double kTolerance = 1e-12;  // of a matrix made a quaternion again
  EXPECT_LT(off.Angle() + off.translation.norm(), kTolerance);
  EXPECT_EQ(FormatImuCalibration({}), "");
}

TEST_F(ImuCalibrationFileTest, BadValuesAreOneLine) {
  const struct {
    std::string text;
    std::string problem;
  } kCases[] = {
      {"rate_hz: 200\n", "imu.yaml: says nothing on an inertial sensor"},
      {"T_cam_imu: [1, 2]\n", "imu.yaml:1: T_cam_imu needs a list of 4"},
      {"T_cam_imu: [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
       "T_cam_imu contains no valid rotation"},
      {"T_imu_cam: [[1, 0, 0, 20], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
       "T_imu_cam has a translation of 20; it must be in m, at most 10"},
      {"T_cam_inu: 1\n", "did you mean T_cam_imu?"},
      {"imu0:\n  gyroscope_noise_densty: 1\n",
       "imu.yaml:2: imu0.gyroscope_noise_densty"},
      {"timeshift_cam_imu: 5\n", "timeshift_cam_imu must be at most 1 s"},
      {"gyroscope_noise_density: 0.001\n", "gyroscope_random_walk is missing"}};
  for (const auto& bad : kCases) {
    ExpectInputError([&] { Read(bad.text); }, {bad.problem});
  }
  ExpectInputError(
      [&] {
        std::string text = kNoise;
        Read(text.replace(text.find("0.0004"), 6, "-0.004"));
      },
      {"imu.yaml:3: gyroscope_noise_density must be above 0"});
}

}  // namespace
}  // namespace rgbd_pose
