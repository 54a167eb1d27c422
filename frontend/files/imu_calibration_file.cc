#include "frontend/files/imu_calibration_file.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <iterator>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_keys.h"

namespace rgbd_pose {
namespace {

struct NoiseKey {
  const char* name;  // of Kalibr
  const char* in_orb_slam3;
  double ImuNoise::*value;
  double most;  // larger values are those of other units
};
constexpr NoiseKey kNoiseKeys[] = {
    {"gyroscope_noise_density", "IMU.NoiseGyro", &ImuNoise::gyro_density, 1.0},
    {"gyroscope_random_walk", "IMU.GyroWalk", &ImuNoise::gyro_walk, 1.0},
    {"accelerometer_noise_density", "IMU.NoiseAcc", &ImuNoise::accel_density,
     10.0},
    {"accelerometer_random_walk", "IMU.AccWalk", &ImuNoise::accel_walk, 10.0}};

constexpr char kCamFromImu[] = "T_cam_imu";
// Of OpenVINS, and of ORB-SLAM3's newer and older files.
constexpr const char* kImuFromCam[] = {"T_imu_cam", "IMU.T_b_c1", "Tbc"};
constexpr char kDelay[] = "timeshift_cam_imu";

// Both are on one body, so that a greater distance is in mm.
Rigid3d ReadMotion(const YamlSection& section, const char* key) {
  constexpr double kMost = 10.0;  // m
  const Rigid3d motion = section.RigidMotion(key);
  if (motion.translation.norm() > kMost) {
    section.Fail(key, Format("has a translation of %.4g; it must be in m, at "
                             "most %g",
                             motion.translation.norm(), kMost));
  }
  return motion;
}

std::optional<Rigid3d> ReadMounting(const YamlSection& section) {
  if (section.Has(kCamFromImu)) return ReadMotion(section, kCamFromImu);
  for (const char* key : kImuFromCam) {
    if (section.Has(key)) return ReadMotion(section, key).Inverse();
  }
  return std::nullopt;
}

std::optional<double> ReadDelay(const YamlSection& section) {
  constexpr double kMost = 1.0;  // s
  if (!section.Has(kDelay)) return std::nullopt;
  const double delay = section.Number(kDelay);
  if (std::abs(delay) > kMost) {
    section.Fail(kDelay, Format("must be at most %g s", kMost));
  }
  return delay;
}

std::optional<ImuNoise> ReadNoise(const YamlSection& section) {
  for (const auto name : {&NoiseKey::name, &NoiseKey::in_orb_slam3}) {
    bool has_any = false;
    for (const NoiseKey& key : kNoiseKeys) has_any |= section.Has(key.*name);
    if (!has_any) continue;
    ImuNoise noise;
    for (const NoiseKey& key : kNoiseKeys) {
      const double value = section.Number(key.*name);
      if (!(value > 0.0) || value > key.most) {
        section.Fail(
            key.*name,
            Format("must be above 0 and at most %g, in rad and m", key.most));
      }
      noise.*key.value = value;
    }
    return noise;
  }
  return std::nullopt;
}

ImuCalibration ReadSection(const YamlSection& section) {
  return {ReadMounting(section), ReadDelay(section), ReadNoise(section)};
}

}  // namespace

std::vector<std::string> ImuKeys() {
  std::vector<std::string> keys = {kCamFromImu, kDelay};
  for (const NoiseKey& key : kNoiseKeys) keys.push_back(key.name);
  keys.insert(keys.end(), std::begin(kImuFromCam), std::end(kImuFromCam));
  for (const NoiseKey& key : kNoiseKeys) keys.push_back(key.in_orb_slam3);
  return keys;
}

ImuCalibration ReadImuCalibration(const YamlSection& file) {
  ImuCalibration calibration = ReadSection(file);
  for (const char* name : {"imu0", "cam0"}) {
    if (!file.Has(name)) continue;
    calibration.CompleteFrom(ReadSection(file.Child(name)));
  }
  return calibration;
}

ImuCalibration ReadImuCalibrationFile(const std::string& path) {
  const YamlSection file = YamlSection::FromFile(path);
  CheckImuKeys(file);
  const ImuCalibration calibration = ReadImuCalibration(file);
  if (!calibration.IsEmpty()) return calibration;
  throw InputError(path +
                   ": says nothing on an inertial sensor; keys are those of "
                   "Kalibr and ORB-SLAM3: " +
                   Join(ImuKeys()));
}

std::string FormatImuCalibration(const ImuCalibration& calibration) {
  std::string text;
  if (calibration.cam_from_imu.has_value()) {
    text += "# Axes of the inertial sensor in those of the colour camera, m.\n";
    text += std::string(kCamFromImu) + ":\n";
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() =
        calibration.cam_from_imu->rotation.toRotationMatrix();
    matrix.topRightCorner<3, 1>() = calibration.cam_from_imu->translation;
    for (int row = 0; row < 4; ++row) {
      std::vector<std::string> words;
      for (int k = 0; k < 4; ++k) words.push_back(ShortNumber(matrix(row, k)));
      text += "- [" + Join(words) + "]\n";
    }
  }
  if (calibration.delay_s.has_value()) {
    text += "# Stamps of the sensor less those of the camera, s.\n";
    text +=
        std::string(kDelay) + ": " + ShortNumber(*calibration.delay_s) + "\n";
  }
  if (calibration.noise.has_value()) {
    text += "# In continuous time; rad, m, s.\n";
    for (const NoiseKey& key : kNoiseKeys) {
      text += std::string(key.name) + ": " +
              ShortNumber((*calibration.noise).*key.value) + "\n";
    }
  }
  return text;
}

}  // namespace rgbd_pose
