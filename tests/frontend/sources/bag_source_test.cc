#include "core/util/text_file.h"
#include "frontend/sources/tum_writer.h"
#include "tests/frontend/bags/ros1_bag_fixture.h"

namespace rgbd_pose {
namespace {

TEST_F(Ros1BagTest, SortsWhatIsSlightlyOutOfOrder) {
  Begin();
  for (int k = 0; k < kFrames; ++k) {
    const int other = k ^ 1;  // neighbours are exchanged in pairs
    Write(kColor, StampOf(k),
          MakeImage(ColorImage(other), "bgr8", StampOf(other)));
    Write(kDepth, StampOf(k) + 0.2,  // recorded much later
          MakeImage(DepthImage(k), "16UC1", StampOf(k) + 0.004));
  }
  ExpectFrames(Source().get(), kFrames);
}

TEST_F(Ros1BagTest, RefusesWhatIsFarOutOfOrder) {
  Begin();
  for (int k = 0; k < 40; ++k) {
    const int other = (k + 20) % 40;
    Write(kColor, StampOf(k), MakeImage(ColorImage(k), "bgr8", StampOf(other)));
    Write(kDepth, StampOf(k),
          MakeImage(DepthImage(k), "16UC1", StampOf(other)));
  }
  ExpectRefused({"a.bag: ", kColor, "out of order", "header stamps"});
}

TEST_F(Ros1BagTest, SaysThatItTakesTheTimesOfRecording) {
  Begin();
  for (int k = 0; k < 2; ++k) {
    Write(kColor, StampOf(k), MakeImage(ColorImage(k), "bgr8", 0.0));
    Write(kDepth, StampOf(k), MakeImage(DepthImage(k), "16UC1", 0.0));
  }
  const auto source = Source();
  EXPECT_NEAR(source->Next()->timestamp, StampOf(0), 1e-6);
  while (source->Next().has_value()) {
  }
  EXPECT_NE(source->remarks().back().find(
                "4 images have no time stamp in their headers: the times of "
                "recording are used"),
            std::string::npos);
}

TEST_F(Ros1BagTest, LeavesOutImagesWithoutPairs) {
  Begin();
  for (int k = 0; k < kFrames; ++k) {
    WriteColor(k);
    if (k != 3 && k < 10) WriteDepth(k);
  }
  const auto source = Source();
  int frames = 0;
  while (source->Next().has_value()) ++frames;
  EXPECT_EQ(frames, 9);
  EXPECT_EQ(source->unmatched_color(), kFrames - 9);
}

TEST_F(Ros1BagTest, RefusesImagesOfOtherTimes) {
  Begin();
  WriteColor(0);
  Write(kDepth, kStart, MakeImage(DepthImage(0), "16UC1", kStart + 5));
  ExpectRefused(
      {"none of 1 colour images", "of one of 1 depth images", "5.000000 s"});
}

TEST_F(Ros1BagTest, MotionCaptureIsTheGroundTruth) {
  const Rigid3d kinect_from_camera =
      Rigid3d::FromRotationVector({-M_PI / 2, 0, 0}, {0.1, 0.0, 0.0});
  Begin();
  for (int k = 0; k < kFrames; ++k) {
    WriteColor(k);
    WriteDepth(k);
    tf2_msgs::TFMessage message;
    message.transforms.push_back(MakeTransform(
        "/world", "/kinect", StampOf(k), {{1, 0, 0, 0}, {0.01 * k, 0, 1}}));
    message.transforms.push_back(
        MakeTransform("/kinect", kOptical, StampOf(k), kinect_from_camera));
    Write("/tf", StampOf(k), message);
  }
  const auto source = Source();
  EXPECT_TRUE(source->ground_truth().empty()) << "nothing is read yet";
  ExpectFrames(source.get(), kFrames);
  const Trajectory truth = source->ground_truth();
  ASSERT_EQ(truth.size(), static_cast<size_t>(kFrames));
  for (int k = 0; k < kFrames; ++k) {
    EXPECT_NEAR(truth[k].timestamp, StampOf(k), 1e-6);
    const Eigen::Vector3d ahead =
        truth[k].world_from_cam * Eigen::Vector3d(0, 0, 2);
    EXPECT_LT((ahead - Eigen::Vector3d(0.1 + 0.01 * k, 2, 1)).norm(), 1e-9);
  }
}

TEST_F(Ros1BagTest, ADamagedMessageCostsItsFrame) {
  Begin();
  for (int k = 0; k < kFrames; ++k) {
    if (k == 7) {  // too few bytes for an image
      sensor_msgs::Image cut = MakeImage(ColorImage(k), "bgr8", StampOf(k));
      cut.data.resize(10);
      Write(kColor, StampOf(k) + 0.01, cut);
    } else {
      WriteColor(k);
    }
    WriteDepth(k);
  }
  const auto source = Source();
  TumWriterOptions options;
  options.max_damaged = 0.05;
  const WrittenSequence written =
      WriteTumSequence(source.get(), folder_ / "tum", options);
  EXPECT_EQ(written.frames, kFrames - 1);
  ASSERT_EQ(written.damaged.size(), 1u);
  EXPECT_NE(written.damaged[0].find(kColor), std::string::npos);
}

// Images that still wait for their counterpart become frames nevertheless.
TEST_F(Ros1BagTest, FramesBeforeDamageAreKept) {
  Open(rosbag::compression::LZ4);
  bag_.setChunkThreshold(10 * 1024);
  WriteAll();
  Options();
  std::string bytes = ReadTextFile(path_);
  const size_t place = bytes.rfind("op=\x05", 3 * bytes.size() / 4);
  ASSERT_NE(place, std::string::npos);
  // Within the content of the chunk, which is compressed to about 400 bytes.
  bytes.replace(place + 100, 200, std::string(200, '\x55'));
  folder_.Write("a.bag", bytes);
  const auto source = Source();
  int frames = 0;
  ExpectInputError(
      [&] {
        while (source->Next().has_value()) ++frames;
      },
      {"a.bag: ", "damaged"});
  EXPECT_GE(frames, 12);
  EXPECT_FALSE(source->Next().has_value());
}

}  // namespace
}  // namespace rgbd_pose
