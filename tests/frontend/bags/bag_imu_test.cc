#include "frontend/bags/bag_imu.h"

#include <gmock/gmock.h>
#include <sensor_msgs/Imu.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "frontend/sources/imu_feed.h"
#include "tests/frontend/bags/ros1_bag_fixture.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

class BagImuTest : public Ros1BagTest {
 protected:
  static constexpr char kUnited[] = "/camera/imu";
  static constexpr char kGyro[] = "/camera/gyro/sample";
  static constexpr char kAccel[] = "/camera/accel/sample";

  // x of the gyroscope and of the accelerometer are the time since kStart.
  static sensor_msgs::Imu MakeImu(double after, double gravity = 9.81) {
    sensor_msgs::Imu imu;
    imu.header.stamp = ros::Time(kStart + after);
    imu.header.frame_id = "imu_frame";
    imu.angular_velocity.x = after;
    imu.linear_acceleration.x = after;
    imu.linear_acceleration.z = gravity;
    return imu;
  }
  // From 0.1 s before the first frame on.
  template <typename Make>
  void WriteStream(const std::string& topic, double rate, const Make& make,
                   double seconds = 1.2, double transfer = 0.005) {
    for (int k = 0; k < seconds * rate; ++k) {
      const double after = -0.1 + k / rate;
      Write(topic, kStart + after + transfer, make(after));
    }
  }
  void WriteStream(const std::string& topic, double rate, double seconds = 1.2,
                   double transfer = 0.005) {
    WriteStream(
        topic, rate, [](double after) { return MakeImu(after); }, seconds,
        transfer);
  }
  void WriteUnited(double gravity = 9.81) {
    WriteStream(kUnited, 200.0,
                [gravity](double after) { return MakeImu(after, gravity); });
  }
  void WriteSeparate() {
    WriteStream(kGyro, 400.0, [](double after) {
      sensor_msgs::Imu imu = MakeImu(after, 0.0);
      imu.linear_acceleration.x = 0.0;
      return imu;
    });
    WriteStream(kAccel, 100.0, [](double after) {
      sensor_msgs::Imu imu = MakeImu(after);
      imu.angular_velocity.x = 0.0;
      return imu;
    });
  }

  // Begins a bag with all images.
  void Begin() {
    Open();
    WriteAll();
  }
  std::unique_ptr<FrameSource> SourceWithoutSensor() {
    SourceOptions options = Options();
    options.imu = "none";
    return OpenSource("auto", options);
  }

  // Expects the samples of all frames, which reach beyond each.
  static void ExpectSamples(FrameSource* source, double rate) {
    std::vector<ImuSample> all;
    while (const std::optional<RgbdFrame> next = source->Next()) {
      all.insert(all.end(), next->imu.begin(), next->imu.end());
      ASSERT_FALSE(all.empty());
      EXPECT_GE(all.back().stamp, next->timestamp + ImuFeed::kReach);
      EXPECT_LT(all.back().stamp,
                next->timestamp + ImuFeed::kReach + 1.1 / rate);
    }
    ASSERT_GT(all.size(), 100u);
    for (size_t k = 0; k < all.size(); ++k) {
      const double after = all[k].stamp - kStart;
      constexpr double kTolerance = 1e-6;  // stamps are in ns
      EXPECT_NEAR(after, all[0].stamp - kStart + k / rate, kTolerance);
      EXPECT_NEAR(all[k].gyro.x(), after, kTolerance);
      EXPECT_NEAR(all[k].accel.x(), after, kTolerance);
      EXPECT_EQ(all[k].accel.z(), 9.81);
    }
  }
};

TEST_F(BagImuTest, SamplesComeWithTheFrames) {
  Begin();
  WriteUnited();
  const auto source = Source();
  ASSERT_TRUE(source->imu().has_value());
  EXPECT_TRUE(source->imu()->has_gyro);
  EXPECT_TRUE(source->imu()->calibration.IsEmpty());
  ExpectSamples(source.get(), 200.0);
  EXPECT_THAT(source->remarks(), testing::IsEmpty());
}

// A recorder that receives them in packets, long after the images.
TEST_F(BagImuTest, SamplesThatArriveLateComeWithTheirFrames) {
  Begin();
  WriteStream(kUnited, 200.0, /*seconds=*/1.2, /*transfer=*/0.6);
  ExpectSamples(Source().get(), 200.0);
}

TEST_F(BagImuTest, ImagesStayAsTheyWereWithoutIt) {
  Begin();
  WriteUnited();
  ExpectFrames(Source().get(), kFrames);
  const auto without = SourceWithoutSensor();
  EXPECT_FALSE(without->imu().has_value());
  EXPECT_TRUE(without->Next()->imu.empty());
}

// A RealSense whose driver does not unite the streams.
TEST_F(BagImuTest, SeparateStreamsAreInterpolatedToOne) {
  Begin();
  WriteSeparate();
  const auto source = Source();
  EXPECT_TRUE(source->imu()->has_gyro);
  ExpectSamples(source.get(), 400.0);
}

TEST_F(BagImuTest, AGyroscopeAloneIsLeftOutWithALine) {
  Begin();
  WriteStream(kGyro, 400.0, [](double after) { return MakeImu(after, 0.0); });
  const auto source = Source();
  EXPECT_FALSE(source->imu().has_value());
  EXPECT_THAT(source->remarks(),
              testing::ElementsAre(HasSubstr(
                  "a.bag: /camera/gyro/sample is not used: no topic has")));
  ExpectFrames(source.get(), kFrames);
  EXPECT_THAT(SourceWithoutSensor()->remarks(), testing::IsEmpty());
}

TEST_F(BagImuTest, AUnitedStreamIsTakenBeforeSeparateOnes) {
  Begin();
  WriteSeparate();
  WriteUnited();
  ExpectSamples(Source().get(), 200.0);
  SourceOptions options = Options();
  options.topics = {kAccel, kGyro};
  ExpectSamples(OpenSource("auto", options).get(), 400.0);
  options.topics = {kColor, kUnited, kDepth};
  ExpectSamples(OpenSource("auto", options).get(), 200.0);
  options.topics = {kGyro};
  ExpectRefusedSource(options, {"a.bag: topics: /camera/gyro/sample are not "
                                "one inertial sensor"});
}

// The sensor of the camera, not that of the robot.
TEST_F(BagImuTest, TheSensorOfTheCameraIsTakenOfSeveral) {
  Begin();
  WriteUnited();
  WriteStream("/base/imu", 50.0);
  const auto source = Source();
  ExpectSamples(source.get(), 200.0);
  EXPECT_THAT(source->remarks(),
              testing::ElementsAre(HasSubstr("/camera/imu is taken for the "
                                             "inertial sensor")));
}

TEST_F(BagImuTest, TheMountingIsThatOfFixedTransforms) {
  const Rigid3d optical_from_imu =
      Rigid3d::FromRotationVector({M_PI / 2, 0, 0}, {0.01, 0.02, 0.03});
  Open();
  tf2_msgs::TFMessage message;
  message.transforms.push_back(MakeTransform("/camera_link", kOptical, kStart,
                                             {{1, 0, 0, 0}, {1, 2, 3}}));
  message.transforms.push_back(
      MakeTransform("/camera_link", "imu_frame", kStart,
                    Rigid3d({1, 0, 0, 0}, {1, 2, 3}) * optical_from_imu));
  Write("/tf_static", kStart, message);
  WriteAll();
  WriteUnited();
  const auto known = Source()->imu()->calibration;
  ASSERT_TRUE(known.cam_from_imu.has_value());
  const Rigid3d off = known.cam_from_imu->Inverse() * optical_from_imu;
  EXPECT_LT(off.Angle() + off.translation.norm(), 1e-9);
  // A calibration of the user overrides it.
  SourceOptions options = Options();
  options.imu = folder_.Write(
      "imu.yaml",
      "T_cam_imu: [[1, 0, 0, 7], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]");
  EXPECT_EQ(OpenSource("auto", options)
                ->imu()
                ->calibration.cam_from_imu->translation.x(),
            7.0);
}

// The bag of the RealSense viewer, where each stream has its transform.
TEST_F(BagImuTest, TheMountingIsThatOfTheViewersTransforms) {
  const std::string sensor = "/device_0/sensor_";
  const std::string color = sensor + "1/Color_0";
  const std::string accel = sensor + "2/Accel_0";
  const std::string gyro = sensor + "2/Gyro_0";
  Open();
  for (const std::string& stream : {sensor + "0/Depth_0", color}) {
    Write(stream + "/info/camera_info", kStart, MakeInfo(SmallCamera().camera));
    Write(stream + "/tf/0", kStart, MakeMotion({}));
    Write(stream + "/image/data", kStart,
          stream == color ? MakeImage(ColorImage(0), "rgb8", kStart, "")
                          : MakeImage(DepthImage(0), "mono16", kStart, ""));
  }
  Write(accel + "/tf/0", kStart, MakeMotion({{1, 0, 0, 0}, {0.01, 0, 0}}));
  WriteStream(accel + "/imu/data", 63.0);
  WriteStream(gyro + "/imu/data", 200.0);
  const auto source = Source();
  EXPECT_EQ(source->imu()->calibration.cam_from_imu->translation.x(), -0.01);
  const std::vector<ImuSample> samples = source->Next()->imu;
  ASSERT_GT(samples.size(), 25u);
  EXPECT_NEAR(samples[1].stamp - samples[0].stamp, 0.005, 1e-6);
}

// A Kinect's driver, with -1 for what it does not measure.
TEST_F(BagImuTest, AnAccelerometerAloneIsOne) {
  Begin();
  WriteStream("/imu", 100.0, [](double after) {
    sensor_msgs::Imu imu = MakeImu(after);
    imu.angular_velocity_covariance[0] = -1.0;
    imu.angular_velocity.x = 77.0;
    return imu;
  });
  const auto source = Source();
  EXPECT_FALSE(source->imu()->has_gyro);
  EXPECT_EQ(source->Next()->imu.at(0).gyro.x(), 0.0);
}

TEST_F(BagImuTest, WrongUnitsAreOneLine) {
  Begin();
  WriteUnited(1.0);
  ExpectRefused({"a.bag: /camera/imu: accelerations are 1", "gravity is in g",
                 "--imu=none"});
  ExpectFrames(SourceWithoutSensor().get(), kFrames);
}

TEST_F(BagImuTest, ASensorThatStopsDoesNotHoldUpTheFrames) {
  Begin();
  WriteStream(kUnited, 200.0, /*seconds=*/0.2);
  ExpectFrames(Source().get(), kFrames);
}

TEST_F(BagImuTest, SamplesSentTwiceAreLeftOutAndCounted) {
  Begin();
  WriteStream(kUnited, 400.0, [](double after) {
    return MakeImu(std::floor(after * 200.0) / 200.0);
  });
  const auto source = Source();
  while (source->Next().has_value()) {
  }
  EXPECT_THAT(source->remarks(),
              testing::ElementsAre(testing::ContainsRegex(
                  "/camera/imu: left out [0-9]+ inertial samples")));
}

TEST_F(BagImuTest, ACalibrationNeedsASensor) {
  Begin();
  SourceOptions options = Options();
  options.imu = folder_.Write("imu.yaml", "timeshift_cam_imu: 0.1");
  ExpectRefusedSource(options, {"a.bag: has no inertial sensor"});
}

}  // namespace
}  // namespace rgbd_pose
