// Files of what is known of an inertial sensor (YAML).

#include <cmath>

#include "frontend/files/imu_calibration_file.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(imu_calibration_file) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("imu.yaml", FuzzText(data, size));
  MayRefuse([&] {
    const ImuCalibration known = ReadImuCalibrationFile(file);
    Require(!known.IsEmpty(), "something");
    if (known.noise) Require(known.noise->Check().empty(), "a usable noise");
    if (known.delay_s) Require(std::isfinite(*known.delay_s), "a delay");
    if (known.cam_from_imu) Require(known.cam_from_imu->IsFinite(), "a motion");
    const ImuCalibration again = ReadImuCalibrationFile(
        folder.Write("again.yaml", FormatImuCalibration(known)));
    Require(again.delay_s == known.delay_s, "the same delay");
    Require(
        again.noise.has_value() == known.noise.has_value() &&
            again.cam_from_imu.has_value() == known.cam_from_imu.has_value(),
        "a calibration that is written as it is");
  });
  return 0;
}
