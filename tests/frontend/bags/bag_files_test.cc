#include "frontend/bags/bag_reader.h"

#ifdef RGBD_POSE_MCAP
#include <zstd.h>
#endif

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "frontend/bags/chunk_codec.h"
#include "tests/frontend/bags/ros2_database.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

class Ros2BagTest : public BagTest {
 protected:
  static constexpr int kFrames = 12;

  void ExpectRefused(const std::string& name,
                     const std::vector<std::string>& parts) {
    ExpectRefusedSource(OptionsFor(name), parts);
  }
};

TEST_F(Ros2BagTest, ReadsAFile) {
  Ros2Database(folder_ / "a.db3").WriteFrames(0, kFrames);
  const auto source = OpenSource("auto", OptionsFor("a.db3"));
  ExpectFrames(source.get(), kFrames);
  EXPECT_TRUE(source->ground_truth().empty());
}

TEST_F(Ros2BagTest, ReadsAFolderOfFiles) {
  folder_.Write("bag/metadata.yaml", "rosbag2_bagfile_information:\n");
  for (int k = 0; k < kFrames; ++k) {
    Ros2Database part(folder_ / ("bag/bag_" + std::to_string(k) + ".db3"));
    // Each part has different topic ids.
    if (k % 2 == 0) part.Write("/chatter", "std_msgs/msg/String", kStart, "");
    part.WriteFrames(k, k + 1);
  }
  ExpectFrames(OpenSource("auto", OptionsFor("bag")).get(), kFrames);
}

TEST_F(Ros2BagTest, ReadsWithoutAnIndexOfTimes) {
  Ros2Database database(folder_ / "a.db3");
  database.WriteFrames(0, kFrames);
  database.Execute("DROP INDEX timestamp_idx");
  ExpectFrames(OpenSource("rosbag2", OptionsFor("a.db3")).get(), kFrames);
}

// Opening a database that has a write-ahead log leaves no files there.
TEST_F(Ros2BagTest, ReadsOneWithALogAndLeavesNoFiles) {
  std::filesystem::create_directories(folder_ / "log");
  std::filesystem::create_directories(folder_ / "left");
  {
    Ros2Database database(folder_ / "log/a#1.db3");
    database.Execute("PRAGMA journal_mode=WAL; PRAGMA wal_autocheckpoint=0");
    database.WriteFrames(0, kFrames);
    // The files that a killed recorder leaves.
    for (const std::string end : {"", "-wal"}) {
      std::filesystem::copy_file(folder_ / ("log/a#1.db3" + end),
                                 folder_ / ("left/a.db3" + end));
    }
  }
  const auto source = OpenSource("auto", OptionsFor("log/a#1.db3"));
  ExpectFrames(source.get(), kFrames);
  int files = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(folder_ / "log")) {
    EXPECT_EQ(file.path().filename(), "a#1.db3");
    ++files;
  }
  EXPECT_EQ(files, 1);
  ExpectFrames(OpenSource("auto", OptionsFor("left/a.db3")).get(), kFrames);
}

TEST_F(Ros2BagTest, MotionCaptureIsTheGroundTruth) {
  Ros2Database database(folder_ / "a.db3");
  database.WriteFrames(0, kFrames);
  for (int k = 0; k < kFrames; ++k) {
    database.WriteTransform(StampOf(k), "world", "rig", {0.5 * k, 0, 0});
    database.WriteTransform(StampOf(k), "rig", Ros2Database::kOptical,
                            {0, 0, 1});
  }
  const auto source = OpenSource("auto", OptionsFor("a.db3"));
  ExpectFrames(source.get(), kFrames);
  const Trajectory truth = source->ground_truth();
  ASSERT_EQ(truth.size(), static_cast<size_t>(kFrames));
  EXPECT_EQ(truth[4].world_from_cam.translation, Eigen::Vector3d(2, 0, 1));
}

TEST_F(Ros2BagTest, SaysWhereAlignedDepthIsOfAnotherFrame) {
  Ros2Database database(folder_ / "a.db3");
  database.WriteInfo("/camera/color/camera_info");
  database.WriteImage(Ros2Database::kColor, ColorImage(0), "bgr8", kStart);
  database.WriteImage(Ros2Database::kDepth, DepthImage(0), "16UC1", kStart,
                      "depth_optical");
  const auto source = OpenSource("auto", OptionsFor("a.db3"));
  ASSERT_TRUE(source->Next().has_value());
  ASSERT_EQ(source->remarks().size(), 1u);
  EXPECT_NE(source->remarks()[0].find("'depth_optical', that of colour 'color"),
            std::string::npos);
}

#ifdef RGBD_POSE_MCAP

std::string PackZstd(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(),
                              bytes.size(), 3));
  return packed;
}

// --compression-mode message.
TEST_F(Ros2BagTest, ReadsPackedMessages) {
  {
    Ros2Database database(folder_ / "a.db3");
    database.pack = PackZstd;
    database.WriteFrames(0, kFrames);
  }
  ExpectFrames(OpenSource("auto", OptionsFor("a.db3")).get(), kFrames);
  Ros2Database cut(folder_ / "cut.db3");
  cut.pack = [](const std::string& bytes) {
    const std::string packed = PackZstd(bytes);
    return packed.substr(0, packed.size() / 2);
  };
  cut.WriteFrames(0, kFrames);
  ExpectRefused("cut.db3", {"cut.db3: a message: cannot be decompressed"});
}

// Recorders that compress in a stream do not know the size when they begin.
TEST(UnpackMessageTest, TheSizeNeedNotBeStored) {
  std::string message(300000, 'a');
  for (size_t i = 0; i < message.size(); i += 7)
    message[i] = char('a' + i % 23);
  ZSTD_CStream* const stream = ZSTD_createCStream();
  ZSTD_initCStream(stream, 1);
  std::string packed(ZSTD_compressBound(message.size()), '\0');
  ZSTD_inBuffer in = {message.data(), message.size(), 0};
  ZSTD_outBuffer out = {packed.data(), packed.size(), 0};
  while (in.pos < in.size) ZSTD_compressStream(stream, &out, &in);
  ASSERT_EQ(ZSTD_endStream(stream, &out), 0u);
  ZSTD_freeCStream(stream);
  packed.resize(out.pos);
  ASSERT_EQ(ZSTD_getFrameContentSize(packed.data(), packed.size()),
            ZSTD_CONTENTSIZE_UNKNOWN);
  EXPECT_EQ(UnpackMessage(packed), message);
  EXPECT_EQ(UnpackMessage(PackZstd(message)), message);
  EXPECT_EQ(UnpackMessage("ros"), "ros");
  ExpectInputError([&] { UnpackMessage(packed.substr(0, packed.size() / 2)); },
                   {"cannot be decompressed"});
}

// --compression-mode file.
TEST_F(Ros2BagTest, ReadsPackedFilesAndLeavesNothing) {
  const std::string temporary = folder_ / "temporary";
  std::filesystem::create_directories(temporary);
  setenv("TMPDIR", temporary.c_str(), 1);
  for (int k = 0; k < 2; ++k) {
    const std::string name = "bag_" + std::to_string(k) + ".db3";
    Ros2Database(folder_ / name).WriteFrames(6 * k, 6 * k + 6);
    folder_.Write("bag/" + name + ".zstd",
                  PackZstd(ReadTextFile(folder_ / name)));
  }
  ExpectFrames(OpenSource("auto", OptionsFor("bag")).get(), kFrames);
  folder_.Write("cut/a.db3.zstd",
                PackZstd(ReadTextFile(folder_ / "bag_0.db3")).substr(0, 500));
  ExpectRefused("cut", {"a.db3.zstd: is damaged or cut off"});
  folder_.Write("text/a.db3.zstd", "no zstd");
  ExpectRefused("text", {"a.db3.zstd: is damaged or cut off"});
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
  unsetenv("TMPDIR");
}

#endif

TEST_F(Ros2BagTest, RefusesWhatIsNoRecording) {
  Ros2Database(folder_ / "a.db3").WriteInfo("/camera_info");
  ExpectRefused("a.db3", {"has no readable colour images", "/camera_info"});

  folder_.Write("empty.db3", "");
  ExpectRefused("empty.db3", {"empty.db3: is empty"});
  folder_.Write("text.db3", "no database, but a text");
  ExpectRefused("text.db3", {"text.db3: cannot be read as a ROS 2 bag"});
}

TEST_F(Ros2BagTest, RefusesDamagedFiles) {
  Ros2Database(folder_ / "a.db3").WriteFrames(0, kFrames);
  const std::string whole = ReadTextFile(folder_ / "a.db3");
  for (const double share : {0.001, 0.3, 0.9}) {
    folder_.Write("cut.db3", whole.substr(0, share * whole.size()));
    ExpectRefused("cut.db3", {"cut.db3: "});
  }
}

TEST_F(Ros2BagTest, RefusesMessagesThatEndTooEarly) {
  Ros2Database database(folder_ / "a.db3");
  database.WriteFrames(0, kFrames);
  database.Execute("UPDATE messages SET data = substr(data, 1, 60) WHERE id=8");
  ExpectRefused("a.db3", {"a.db3: /camera", "image_raw: ", "ends too early"});
}

constexpr double kRate = 200.0;  // Hz
constexpr double kFirst = BagTest::kStart - 0.1;

double StampOfSample(int k) { return kFirst + k / kRate; }

// sensor_msgs/Imu in CDR: sample k turns by k rad/s about x.
std::string ImuMessage(int k) {
  CdrWriter writer;
  writer.Header(StampOfSample(k), "imu_frame");
  writer.Numbers({0, 0, 0, 1});
  writer.Numbers(std::vector<double>(9, 0.0));
  writer.Numbers({0.1 * k, 0.2, 0.3});
  writer.Numbers(std::vector<double>(9, 0.0));
  writer.Numbers({0.5, -9.8, 0.1});
  return writer.Numbers(std::vector<double>(9, 0.0)).message();
}

using Ros2ImuTest = BagTest;

TEST_F(Ros2ImuTest, IsRead) {
  Ros2Database bag(folder_ / "bag.db3");
  bag.WriteFrames(0, 10);
  for (int k = 0; k < 250; ++k) {
    bag.Write("/camera/imu", "sensor_msgs/msg/Imu", StampOfSample(k) + 0.005,
              ImuMessage(k));
  }
  const auto source = OpenSource("auto", OptionsFor("bag.db3"));
  ASSERT_TRUE(source->imu().has_value());
  std::vector<ImuSample> all;
  int count = 0;
  while (const std::optional<RgbdFrame> next = source->Next()) {
    all.insert(all.end(), next->imu.begin(), next->imu.end());
    ++count;
  }
  EXPECT_EQ(count, 10);
  ASSERT_GT(all.size(), 20u);
  for (size_t k = 0; k < all.size(); ++k) {
    EXPECT_NEAR(all[k].stamp, StampOfSample(static_cast<int>(k)), 1e-6);
    EXPECT_EQ(all[k].gyro, Eigen::Vector3d(0.1 * k, 0.2, 0.3));
    EXPECT_EQ(all[k].accel, Eigen::Vector3d(0.5, -9.8, 0.1));
  }
}

}  // namespace
}  // namespace rgbd_pose
