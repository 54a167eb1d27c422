#include "frontend/sources/imu_beside.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "core/util/format.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/frame_stream.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

constexpr char kNoise[] =
    "gyroscope_noise_density: 1.0e-03\n"
    "gyroscope_random_walk: 2.0e-05\n"
    "accelerometer_noise_density: 3.0e-02\n"
    "accelerometer_random_walk: 4.0e-04\n";

// Of a sensor with axes z to the left, y up; 2 cm to the right of the camera.
constexpr char kMounting[] =
    "T_cam_imu:\n"
    "- [0.0, 0.0, -1.0, 0.02]\n"
    "- [0.0, -1.0, 0.0, 0.0]\n"
    "- [-1.0, 0.0, 0.0, 0.0]\n"
    "- [0.0, 0.0, 0.0, 1.0]\n";

// The frames are at 1.00, 1.04 and 1.10 s.
class ImuBesideTest : public TumSequenceTest {
 protected:
  // Samples every 10 ms from 0.9 to 1.3 s; z of the gyroscope counts them.
  static std::string Rows(double delay = 0.0, double gravity = 9.81) {
    std::string text = "#timestamp [s],w_x,w_y,w_z,a_x,a_y,a_z\n";
    for (int k = 0; k <= 40; ++k) {
      text +=
          Format("%.3f,0,0,%d,0,0,%g\n", 0.9 + 0.01 * k + delay, k, gravity);
    }
    return text;
  }

  std::unique_ptr<FrameSource> Open() { return OpenSource("auto", options_); }

  // How many samples come with each frame of a source.
  static std::vector<int> Counts(FrameSource* source) {
    std::vector<int> counts;
    int number = -1;
    while (const std::optional<RgbdFrame> next = source->Next()) {
      counts.push_back(static_cast<int>(next->imu.size()));
      for (const ImuSample& sample : next->imu) {
        if (number >= 0) {
          EXPECT_EQ(sample.gyro.z(), number + 1.0);
        }
        number = static_cast<int>(sample.gyro.z());
      }
    }
    return counts;
  }
};

TEST_F(ImuBesideTest, RecordingsWithoutItHaveNoSensor) {
  const auto source = Open();
  EXPECT_FALSE(source->imu().has_value());
  EXPECT_EQ(Counts(source.get()), (std::vector<int>{0, 0, 0}));
}

TEST_F(ImuBesideTest, SamplesComeWithTheFrames) {
  for (const char* name : {"imu.csv", "imu.txt"}) {
    SCOPED_TRACE(name);
    const std::string file = folder_.Write(name, Rows());
    const auto source = Open();
    ASSERT_TRUE(source->imu().has_value());
    EXPECT_TRUE(source->imu()->has_gyro);
    EXPECT_TRUE(source->imu()->calibration.IsEmpty());
    EXPECT_EQ(source->timestamps().size(), 3u);
    EXPECT_EQ(source->unmatched_color(), 1);
    EXPECT_EQ(source->remarks().size(), 0u);
    // From 0.90 to 1.15, 1.19 and 1.25 s; 0.90 + 0.01 * k is rounded.
    const std::vector<int> counts = Counts(source.get());
    ASSERT_EQ(counts.size(), 3u);
    EXPECT_NEAR(counts[0], 26, 1);
    EXPECT_NEAR(counts[0] + counts[1], 30, 1);
    EXPECT_NEAR(counts[0] + counts[1] + counts[2], 36, 1);
    std::filesystem::remove(file);
  }
}

TEST_F(ImuBesideTest, AnyPartAndAnyNumberOfThreadsGetThem) {
  folder_.Write("imu.csv", Rows());
  const std::vector<int> whole = Counts(Open().get());
  EXPECT_EQ(Counts(PartOf(Open(), ParseFrameRange("0-2:2")).get()),
            (std::vector<int>{whole[0], whole[1] + whole[2]}));
  EXPECT_EQ(Counts(PartOf(Open(), ParseFrameRange("1-1")).get()),
            (std::vector<int>{whole[0] + whole[1]}));
  const auto source = Open();
  FrameStream stream(source.get(), {}, 3);
  for (const int count : whole) {
    EXPECT_EQ(stream.Next()->imu.size(), static_cast<size_t>(count));
  }
}

TEST_F(ImuBesideTest, DamagedFramesLeaveTheirSamplesToTheNext) {
  folder_.Write("imu.csv", Rows());
  const std::vector<int> whole = Counts(Open().get());
  folder_.Write("depth/0.png", "no image");
  const auto source = Open();
  FrameStream stream(source.get(), {}, 1, /*max_damaged=*/0.5);
  EXPECT_EQ(stream.Next()->imu.size(),
            static_cast<size_t>(whole[0] + whole[1]));
  EXPECT_EQ(stream.Next()->imu.size(), static_cast<size_t>(whole[2]));
}

TEST_F(ImuBesideTest, EachPartOfTheCalibrationComesFromTheNearestFile) {
  folder_.Write("imu.csv", Rows(0.1));
  folder_.Write("imu.yaml", std::string(kMounting) + "timeshift_cam_imu: 0.3");
  options_.imu = folder_.Write("given.yaml", "timeshift_cam_imu: 0.1");
  options_.camera->imu.noise = ImuNoise{0.1, 0.1, 0.1, 0.1};
  const auto source = Open();
  const ImuCalibration known = source->imu()->calibration;
  EXPECT_EQ(known.delay_s, 0.1);
  EXPECT_EQ(known.noise->gyro_walk, 0.1);
  EXPECT_TRUE((*known.cam_from_imu * Eigen::Vector3d(0.0, 0.0, 1.0))
                  .isApprox(Eigen::Vector3d(-0.98, 0.0, 0.0), 1e-9));
  // Stamps are 0.1 s late, so the same samples come with each frame.
  EXPECT_NEAR(Counts(source.get())[0], 26, 1);
}

TEST_F(ImuBesideTest, CameraYamlOfTheFolderMaySayIt) {
  folder_.Write("imu.csv", Rows());
  folder_.Write("camera.yaml",
                "Camera.fx: 30\nCamera.fy: 30\nCamera.cx: 15.5\n"
                "Camera.cy: 11.5\nCamera.width: 32\nCamera.height: 24\n" +
                    std::string(kNoise) + kMounting);
  for (const bool has_other_camera : {true, false}) {
    if (!has_other_camera) options_.camera.reset();
    const ImuCalibration known = Open()->imu()->calibration;
    EXPECT_EQ(known.noise->accel_density, 0.03);
    EXPECT_TRUE(known.cam_from_imu.has_value());
    EXPECT_FALSE(known.delay_s.has_value());
  }
}

TEST_F(ImuBesideTest, TumsAccelerometerIsThatOfAKinect) {
  folder_.Write("accelerometer.txt",
                "# timestamp ax ay az\n1.0 0 9.0 -4\n1.1 0 9.0 -4\n");
  const ImuSensor sensor = *Open()->imu();
  EXPECT_FALSE(sensor.has_gyro);
  const Eigen::Vector3d up =
      sensor.calibration.cam_from_imu->rotation * Eigen::Vector3d(0, 9, -4);
  EXPECT_TRUE(up.isApprox(Eigen::Vector3d(0, -9, -4)));
}

TEST_F(ImuBesideTest, TheSensorOfAPhoneIsThatOfStrayScanner) {
  folder_.Write("imu.csv",
                "timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z\n"
                "1.0, -1.0, 0, 0, 0, 0, 0\n1.1, -1.0, 0, 0, 0, 0, 0\n");
  const auto source = Open();
  const ImuSensor sensor = *source->imu();
  EXPECT_TRUE(sensor.has_gyro);
  const std::vector<ImuSample> samples = source->Next()->imu;
  ASSERT_FALSE(samples.empty());
  const Eigen::Vector3d up =
      sensor.calibration.cam_from_imu->rotation * samples[0].accel;
  EXPECT_TRUE(up.isApprox(Eigen::Vector3d(0, -9.80665, 0)));
}

TEST_F(ImuBesideTest, WrongUnitsAndClocksAreOneLineThatSaysWhatToDo) {
  folder_.Write("imu.csv", Rows(0.0, 1.0));
  ExpectInputError([&] { Open(); }, {"imu.csv: accelerations are 1 ",
                                     "gravity is in g", "--imu=none"});
  folder_.Write("imu.csv", Rows(100.0));
  ExpectInputError([&] { Open(); },
                   {"imu.csv: samples from 100.9", "frames from 1.000000",
                    "same clock", "--imu=none"});
  folder_.Write("imu.csv", Rows(0.0, 5.0));
  EXPECT_THAT(Open()->remarks(),
              testing::ElementsAre(HasSubstr("gravity is 9.81")));
  options_.imu = "none";
  EXPECT_FALSE(Open()->imu().has_value());
}

TEST_F(ImuBesideTest, ACalibrationNeedsASensor) {
  options_.imu = folder_.Write("given.yaml", kNoise);
  ExpectInputError([&] { Open(); }, {"has no samples of an inertial sensor"});
  options_.imu = "none";
  EXPECT_FALSE(Open()->imu().has_value());
}

}  // namespace
}  // namespace rgbd_pose
