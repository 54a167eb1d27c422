#include "frontend/files/imu_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "frontend/files/stray_imu.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

class ImuFileTest : public testing::Test {
 protected:
  ImuRecording Read(const std::string& text) {
    return ReadImuFile(folder_.Write("imu.csv", text));
  }

  TempFolder folder_;
};

TEST_F(ImuFileTest, ReadsEurocsColumnsInNanoseconds) {
  const ImuRecording imu = Read(
      "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n"
      "1403636579758555392,-0.1,0.2,0.03,8.1,-0.4,-5.5\n"
      "1403636579763555584,-0.2,0.3,0.04,8.2,-0.3,-5.4\n");
  ASSERT_EQ(imu.samples.size(), 2u);
  EXPECT_TRUE(imu.has_gyro);
  EXPECT_EQ(imu.warning, "");
  EXPECT_NEAR(imu.samples[0].stamp, 1403636579.758555392, 5e-7);
  EXPECT_EQ(imu.samples[1].gyro, Eigen::Vector3d(-0.2, 0.3, 0.04));
  EXPECT_EQ(imu.samples[1].accel, Eigen::Vector3d(8.2, -0.3, -5.4));
}

TEST_F(ImuFileTest, ReadsSecondsAndAnAccelerometerAlone) {
  const ImuRecording imu = Read(
      "# timestamp ax ay az\n"
      "1305031098.382263 -0.478957 8.010560 -4.166928\n"
      "1305031098.385267 -0.574749 8.202143 -4.166928\n");
  ASSERT_EQ(imu.samples.size(), 2u);
  EXPECT_FALSE(imu.has_gyro);
  EXPECT_EQ(imu.samples[0].stamp, 1305031098.382263);
  EXPECT_EQ(imu.samples[1].accel,
            Eigen::Vector3d(-0.574749, 8.202143, -4.166928));
  EXPECT_TRUE(imu.samples[1].gyro.isZero(0.0));
}

TEST_F(ImuFileTest, AClockMayBeginBelowZero) {
  const ImuRecording imu = Read("-0.51 0 0 9.8\n-0.5 0 0 9.8\n0.01 0 0 9.8\n");
  ASSERT_EQ(imu.samples.size(), 3u);
  EXPECT_EQ(imu.samples[0].stamp, -0.51);
}

TEST_F(ImuFileTest, NamesTheLineOfWhatIsWrong) {
  ExpectInputError([&] { Read("# nothing\n"); }, {"imu.csv: no samples"});
  ExpectInputError([&] { Read("1.0 0 0 9.8\n1.1 0 0\n"); },
                   {"imu.csv:2: 3 columns", "7, or", "4"});
  ExpectInputError([&] { Read("1.0 0 0 9.8 1 2\n"); },
                   {"imu.csv:1: 6 columns"});
  ExpectInputError([&] { Read("1.0 0 0 9.8\n1.1 0 0 nan\n"); },
                   {"imu.csv:2:", "an acceleration"});
  ExpectInputError([&] { Read("1.0 0 0 9.8\n\n0.8 0 0 9.8\n"); },
                   {"imu.csv:3: the stamp is earlier"});
  ExpectInputError([&] { Read("1305031098382 0 0 9.8\n"); },
                   {"imu.csv:1:", "is not in seconds"});
}

TEST_F(ImuFileTest, OfSamplesWithTheSameStampTheFirstIsUsed) {
  const ImuRecording imu =
      Read("1.0 0 0 9.8\n1.0 0 0 9.7\n1.0 0 0 9.6\n1.1 0 0 9.5\n");
  ASSERT_EQ(imu.samples.size(), 2u);
  EXPECT_EQ(imu.samples[0].accel.z(), 9.8);
  EXPECT_EQ(imu.samples[1].accel.z(), 9.5);
  EXPECT_THAT(imu.warning, testing::HasSubstr("2 samples"));
}

TEST_F(ImuFileTest, ExchangedNeighboursAreSorted) {
  const ImuRecording imu =
      Read("1.00 0 0 9.7\n1.02 0 0 9.9\n1.01 0 0 9.8\n1.02 0 0 9.6\n");
  ASSERT_EQ(imu.samples.size(), 3u);
  EXPECT_EQ(imu.samples[0].accel.z(), 9.7);
  EXPECT_EQ(imu.samples[1].accel.z(), 9.8);
  EXPECT_EQ(imu.samples[2].accel.z(), 9.9);
}

TEST_F(ImuFileTest, ReadsWhatItWrites) {
  for (const bool has_gyro : {true, false}) {
    std::vector<ImuSample> samples;
    for (int k = 0; k < 3; ++k) {
      samples.push_back({1.3e9 + 0.005 * k,
                         Eigen::Vector3d::Constant(has_gyro ? 0.1 / 3 : 0.0),
                         {0.1, -0.2, 9.8 + k / 7.0}});
    }
    const ImuRecording read = Read(FormatImuRows({}, has_gyro, true) +
                                   FormatImuRows(samples, has_gyro, false));
    EXPECT_EQ(read.has_gyro, has_gyro);
    ASSERT_EQ(read.samples.size(), samples.size());
    for (size_t k = 0; k < samples.size(); ++k) {
      EXPECT_EQ(read.samples[k].stamp, samples[k].stamp);
      EXPECT_EQ(read.samples[k].gyro, samples[k].gyro);
      EXPECT_EQ(read.samples[k].accel, samples[k].accel);
    }
  }
}

TEST_F(ImuFileTest, RefusesWrongUnits) {
  ExpectInputError([&] { Read("1.0 0 0 1.0\n1.1 0 0 1.0\n"); },
                   {"imu.csv: accelerations are 1 ", "gravity is in g"});
  EXPECT_THAT(Read("1.0 0 0 4.0\n1.1 0 0 4.0\n").warning,
              testing::HasSubstr("gravity is 9.81"));
}

TEST(RealImuFileTest, TumsAccelerometersAreUnderstood) {
  const char* const data = std::getenv("RGBD_POSE_TEST_DATA");
  if (data == nullptr) {
    GTEST_SKIP() << "RGBD_POSE_TEST_DATA does not name a folder of real "
                    "sequences";
  }
  const ImuRecording imu =
      ReadImuFile(std::string(data) + "/tum_fr1_xyz/accelerometer.txt");
  EXPECT_EQ(imu.samples.size(), 15158u);
  EXPECT_EQ(imu.warning, "");
}

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
