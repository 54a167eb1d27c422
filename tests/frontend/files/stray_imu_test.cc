#include "frontend/files/stray_imu.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

class StrayImuTest : public testing::Test {
 protected:
  ImuRecording Read(const std::string& rows) {
    return ReadImuFile(folder_.Write(
        "imu.csv",
        "timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z\n" + rows));
  }
  TempFolder folder_;
};

// A phone in landscape, home button at the right, at rest. Core Motion says
// that gravity is along -x of the screen; the sensor measures upwards.
TEST_F(StrayImuTest, AccelerationsPointUpAndAreMetric) {
  for (const char* rows : {"8.0, -1.0, 0, 0, 0.1, 0.2, 0.3\n",
                           "8.0, -9.80665, 0, 0, 0.1, 0.2, 0.3\n"}) {
    const ImuRecording imu = Read(rows);
    ASSERT_EQ(imu.samples.size(), 1u);
    EXPECT_TRUE(imu.has_gyro);
    EXPECT_EQ(imu.warning, "");
    EXPECT_EQ(imu.samples[0].stamp, 8.0);
    EXPECT_EQ(imu.samples[0].gyro, Vector3d(0.1, 0.2, 0.3));
    EXPECT_TRUE(imu.samples[0].accel.isApprox(Vector3d(9.80665, 0, 0)));
    ASSERT_TRUE(imu.cam_from_imu.has_value());
    const Vector3d in_camera = *imu.cam_from_imu * imu.samples[0].accel;
    EXPECT_TRUE(in_camera.isApprox(Vector3d(0, -9.80665, 0)))
        << "up is -y of the camera";
  }
}

// The camera looks away from the screen, whose z points to the user.
TEST_F(StrayImuTest, TheCameraLooksAwayFromTheScreen) {
  const Rigid3d cam_from_imu = *Read("8, -1, 0, 0, 0, 0, 0\n").cam_from_imu;
  EXPECT_TRUE((cam_from_imu * Vector3d(0, 0, 1)).isApprox(Vector3d(0, 0, -1)));
  EXPECT_TRUE((cam_from_imu * Vector3d(0, 1, 0)).isApprox(Vector3d(-1, 0, 0)));
}

TEST_F(StrayImuTest, RowsThatAreCutOffAreRefused) {
  ExpectInputError([&] { Read("8, -1, 0, 0, 0, 0, 0\n9, -1, 0, 0\n"); },
                   {"imu.csv:3: 4 columns"});
  ExpectInputError([&] { Read(""); }, {"imu.csv: no samples"});
}

}  // namespace
}  // namespace rgbd_pose
