// Mounting, delay and samples of a simulated recording, from the simulator
// through files to the true path: what one of them says wrongly shows here.

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/inertial/imu_buffer.h"
#include "core/inertial/preintegration.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/sources/imu_beside.h"
#include "frontend/sources/open_source.h"
#include "frontend/sources/tum_writer.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// The largest error of the rotations from frame to frame, rad, that the
// gyroscope of a recording predicts.
double LargestError(FrameSource* source, const ImuCalibration& known) {
  const Rigid3d cam_from_imu = known.cam_from_imu.value();
  const double delay = known.delay_s.value();
  ImuBuffer buffer;
  std::vector<double> stamps;
  double largest = 0.0;
  while (const std::optional<RgbdFrame> next = source->Next()) {
    for (const ImuSample& sample : next->imu) buffer.Add(sample);
    stamps.push_back(next->timestamp);
  }
  const Trajectory truth = source->ground_truth();
  for (size_t k = 1; k < stamps.size(); ++k) {
    const PreintegratedMotion motion = Preintegrate(
        buffer.Between(stamps[k - 1] + delay, stamps[k] + delay), {}, {});
    const Eigen::Quaterniond prev_from_cur = cam_from_imu.rotation *
                                             motion.start_from_end *
                                             cam_from_imu.rotation.conjugate();
    const Eigen::Quaterniond exact =
        truth[k - 1].world_from_cam.rotation.conjugate() *
        truth[k].world_from_cam.rotation;
    largest = std::max(largest, exact.angularDistance(prev_from_cur));
  }
  return largest;
}

TEST(ImuPathTest, TheGyroscopeTurnsAsTheTruePath) {
  const TempFolder folder;
  SyntheticOptions options;
  options.frames = 12;
  options.path = "handheld";
  options.camera.camera = {64, 48, 60, 60, 31.5, 23.5};
  SyntheticImuOptions imu;
  imu.noise = false;
  imu.cam_from_imu =
      Rigid3d::FromRotationVector({0.7, -1.1, 0.4}, {0.02, -0.01, 0.03});
  imu.delay_s = 0.012;
  auto dataset = std::make_unique<SyntheticDataset>(options);
  const std::vector<ImuSample> samples = dataset->SimulateImu(imu);
  const auto source =
      WithImu(std::move(dataset), samples,
              {{imu.cam_from_imu, imu.delay_s, imu.densities}, true});
  WriteTumSequence(source.get(), folder / "sequence");
  SourceOptions read;
  read.path = folder / "sequence";

  const auto open = [&read] { return OpenSource("auto", read); };
  const ImuCalibration known = open()->imu()->calibration;
  // Of samples at 200 Hz, and of the digits of the true path.
  constexpr double kTolerance = 2e-5;
  EXPECT_LT(LargestError(open().get(), known), kTolerance);
  // A wrong sign or an inverse is seen.
  ImuCalibration wrong = known;
  wrong.delay_s = 0.0;
  EXPECT_GT(LargestError(open().get(), wrong), 10.0 * kTolerance);
  wrong = known;
  wrong.cam_from_imu = known.cam_from_imu->Inverse();
  EXPECT_GT(LargestError(open().get(), wrong), 10.0 * kTolerance);
}

}  // namespace
}  // namespace rgbd_pose
