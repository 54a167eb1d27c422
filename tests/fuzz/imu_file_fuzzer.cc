// Files of inertial samples: a byte for the layout of a header, then the rows.

#include <cmath>

#include "frontend/files/imu_file.h"
#include "frontend/files/stray_imu.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(imu_file) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  if (size == 0) return 0;
  const bool is_stray = data[0] % 2 == 1;
  const std::string header =
      is_stray ? std::string(kStrayImuColumns) + "\n" : "";
  const std::string file = folder.Write(
      "imu.csv", header + std::string(FuzzText(data + 1, size - 1)));
  MayRefuse([&] {
    const ImuRecording imu = ReadImuFile(file);
    Require(!imu.samples.empty(), "samples");
    double last = -INFINITY;
    for (const ImuSample& sample : imu.samples) {
      Require(sample.stamp > last, "stamps that increase");
      Require(sample.gyro.allFinite() && sample.accel.allFinite(), "numbers");
      last = sample.stamp;
    }
  });
  return 0;
}
