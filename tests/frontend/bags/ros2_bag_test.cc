#include "frontend/bags/ros2_bag.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "core/util/text_file.h"
#include "frontend/files/image_file.h"
#include "frontend/sources/open_source.h"
#include "tests/support/cdr_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

constexpr int kBagFrames = 12;
constexpr double kStart = 1000.0;
constexpr char kColor[] = "/camera/color/image_raw";
constexpr char kDepthTopic[] = "/camera/aligned_depth_to_color/image_raw";
constexpr char kOptical[] = "color_optical";

double StampOf(int k) { return kStart + k / 30.0; }

// A database with the tables that rosbag2 makes, by sqlite3 itself.
class Database {
 public:
  explicit Database(const std::string& path) {
    std::filesystem::remove(path);
    EXPECT_EQ(sqlite3_open(path.c_str(), &database_), SQLITE_OK);
    Execute(
        "PRAGMA synchronous=OFF; PRAGMA journal_mode=OFF;"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type "
        "TEXT NOT NULL, serialization_format TEXT NOT NULL, "
        "offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT "
        "NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void Execute(const std::string& query) {
    EXPECT_EQ(sqlite3_exec(database_, query.c_str(), nullptr, nullptr, nullptr),
              SQLITE_OK)
        << sqlite3_errmsg(database_);
  }

  // One that is there already is not made again.
  void Write(const std::string& topic, const std::string& type, double received,
             const std::string& message) {
    size_t id = 0;
    while (id < topics_.size() && topics_[id] != topic) ++id;
    const std::string number = std::to_string(id + 7);
    if (id == topics_.size()) {
      topics_.push_back(topic);
      Execute("INSERT INTO topics VALUES(" + number + ",'" + topic + "','" +
              type + "','cdr','')");
    }
    const std::string query =
        "INSERT INTO messages(topic_id, timestamp, data) VALUES(" + number +
        "," + std::to_string(static_cast<int64_t>(received * 1e9)) + ",?)";
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database_, query.c_str(), -1, &statement, nullptr);
    sqlite3_bind_blob(statement, 1, message.data(),
                      static_cast<int>(message.size()), SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(statement), SQLITE_DONE);
    sqlite3_finalize(statement);
  }

  void WriteImage(const std::string& topic, const cv::Mat& image,
                  const std::string& encoding, double stamp,
                  const std::string& frame = kOptical) {
    CdrWriter writer;
    writer.Header(stamp, frame);
    writer.Number<uint32_t>(image.rows).Number<uint32_t>(image.cols);
    writer.Text(encoding).Number<uint8_t>(0);
    writer.Number<uint32_t>(image.cols * image.elemSize());
    writer.Bytes({reinterpret_cast<const char*>(image.data),
                  image.total() * image.elemSize()});
    Write(topic, "sensor_msgs/msg/Image", stamp + 0.01, writer.message());
  }

  void WriteInfo(const std::string& topic) {
    const Camera camera = SmallCamera().camera;
    CdrWriter writer;
    writer.Header(kStart, kOptical);
    writer.Number<uint32_t>(camera.height).Number<uint32_t>(camera.width);
    writer.Text("plumb_bob").Number<uint32_t>(5).Numbers({0, 0, 0, 0, 0});
    writer.Numbers({camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
    writer.Numbers({1, 0, 0, 0, 1, 0, 0, 0, 1});
    writer.Numbers(
        {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0});
    writer.Number<uint32_t>(0).Number<uint32_t>(0);          // binning
    for (int i = 0; i < 4; ++i) writer.Number<uint32_t>(0);  // region
    writer.Number<uint8_t>(0);
    Write(topic, "sensor_msgs/msg/CameraInfo", kStart, writer.message());
  }

  void WriteFrames(int first, int last) {
    WriteInfo("/camera/color/camera_info");
    for (int k = first; k < last; ++k) {
      WriteImage(kColor, ColorImage(k), "bgr8", StampOf(k));
      WriteImage(kDepthTopic, DepthImage(k), "16UC1", StampOf(k) + 0.004);
    }
  }

  void WriteTransform(double stamp, const std::string& parent,
                      const std::string& child,
                      const Eigen::Vector3d& translation) {
    CdrWriter writer;
    writer.Number<uint32_t>(1).Header(stamp, parent).Text(child);
    writer.Numbers(
        {translation.x(), translation.y(), translation.z(), 0, 0, 0, 1});
    Write("/tf", "tf2_msgs/msg/TFMessage", stamp, writer.message());
  }

 private:
  sqlite3* database_ = nullptr;
  std::vector<std::string> topics_;
};

class Ros2BagTest : public testing::Test {
 protected:
  SourceOptions Options(const std::string& name) const {
    SourceOptions options;
    options.path = folder_ / name;
    return options;
  }
  static void ExpectFrames(FrameSource* source) {
    EXPECT_EQ(source->camera().depth_scale, 1000.0);
    EXPECT_EQ(source->camera().camera.cx, SmallCamera().camera.cx);
    for (int k = 0; k < kBagFrames; ++k) {
      const std::optional<RgbdFrame> next = source->Next();
      ASSERT_TRUE(next.has_value()) << k;
      EXPECT_NEAR(next->timestamp, StampOf(k), 1e-6);
      const Frame frame = next->read();
      EXPECT_EQ(frame.index, k);
      EXPECT_NEAR(frame.depth_delay, 0.004, 1e-6);
      EXPECT_EQ(frame.depth.at<uint16_t>(5, 5), 1000 + k);
      EXPECT_NEAR(frame.gray.at<uint8_t>(5, 5), 68 + k, 1);
    }
    EXPECT_FALSE(source->Next().has_value());
  }
  void ExpectRefused(const std::string& name,
                     const std::vector<std::string>& parts) {
    ExpectInputError(
        [&] {
          const auto source = OpenSource("auto", Options(name));
          while (const auto next = source->Next()) next->read();
        },
        parts);
  }

  TempFolder folder_;
};

TEST_F(Ros2BagTest, ReadsAFile) {
  Database(folder_ / "a.db3").WriteFrames(0, kBagFrames);
  const auto source = OpenSource("auto", Options("a.db3"));
  ExpectFrames(source.get());
  EXPECT_TRUE(source->ground_truth().empty());
}

TEST_F(Ros2BagTest, ReadsAFolderOfFiles) {
  folder_.Write("bag/metadata.yaml", "rosbag2_bagfile_information:\n");
  for (int k = 0; k < kBagFrames; ++k) {
    Database part(folder_ / ("bag/bag_" + std::to_string(k) + ".db3"));
    // Other ids in each of them.
    if (k % 2 == 0) part.Write("/chatter", "std_msgs/msg/String", kStart, "");
    part.WriteFrames(k, k + 1);
  }
  ExpectFrames(OpenSource("auto", Options("bag")).get());
}

TEST_F(Ros2BagTest, ReadsWithoutAnIndexOfTimes) {
  Database database(folder_ / "a.db3");
  database.WriteFrames(0, kBagFrames);
  database.Execute("DROP INDEX timestamp_idx");
  ExpectFrames(OpenSource("rosbag2", Options("a.db3")).get());
}

TEST_F(Ros2BagTest, ReadsCompressedImages) {
  Database database(folder_ / "a.db3");
  database.WriteInfo("/camera/color/camera_info");
  for (int k = 0; k < kBagFrames; ++k) {
    CdrWriter color;
    color.Header(StampOf(k), kOptical).Text("bgr8; png compressed bgr8");
    color.Bytes(EncodePng(ColorImage(k)));
    database.Write("/camera/color/image_raw/compressed",
                   "sensor_msgs/msg/CompressedImage", StampOf(k),
                   color.message());
    CdrWriter depth;
    depth.Header(StampOf(k) + 0.004, kOptical).Text("16UC1; compressedDepth");
    depth.Bytes(std::string(12, '\0') + EncodePng(DepthImage(k)));
    database.Write("/camera/depth/image_raw/compressedDepth",
                   "sensor_msgs/msg/CompressedImage", StampOf(k),
                   depth.message());
  }
  ExpectFrames(OpenSource("auto", Options("a.db3")).get());
}

TEST_F(Ros2BagTest, MotionCaptureIsTheGroundTruth) {
  Database database(folder_ / "a.db3");
  database.WriteFrames(0, kBagFrames);
  for (int k = 0; k < kBagFrames; ++k) {
    database.WriteTransform(StampOf(k), "world", "rig", {0.5 * k, 0, 0});
    database.WriteTransform(StampOf(k), "rig", kOptical, {0, 0, 1});
  }
  const auto source = OpenSource("auto", Options("a.db3"));
  ExpectFrames(source.get());
  const Trajectory truth = source->ground_truth();
  ASSERT_EQ(truth.size(), static_cast<size_t>(kBagFrames));
  EXPECT_EQ(truth[4].world_from_cam.translation, Eigen::Vector3d(2, 0, 1));
}

TEST_F(Ros2BagTest, SaysWhatMakesOneOfOtherKinds) {
  folder_.Write("mcap/metadata.yaml", "");
  folder_.Write("mcap/mcap_0.mcap", "x");
  ExpectRefused("mcap", {"mcap_0.mcap: is in mcap", "ros2 bag convert"});
  folder_.Write("packed/packed_0.db3.zstd", "x");
  ExpectRefused("packed", {"packed_0.db3.zstd: is packed", "unzstd"});
}

TEST_F(Ros2BagTest, RefusesWhatIsNoRecording) {
  { Database empty(folder_ / "a.db3"); }
  ExpectRefused("a.db3", {"a.db3: has no colour images", "it has nothing"});

  Database(folder_ / "a.db3").WriteInfo("/camera_info");
  ExpectRefused("a.db3", {"has no colour images", "/camera_info"});

  folder_.Write("empty.db3", "");
  ExpectRefused("empty.db3", {"empty.db3: is empty"});
  folder_.Write("text.db3", "no database, but a text");
  ExpectRefused("text.db3", {"text.db3: cannot be read as a ROS 2 bag"});
}

TEST_F(Ros2BagTest, RefusesDamagedFiles) {
  Database(folder_ / "a.db3").WriteFrames(0, kBagFrames);
  const std::string whole = ReadTextFile(folder_ / "a.db3");
  for (const double share : {0.001, 0.3, 0.9}) {
    folder_.Write("cut.db3", whole.substr(0, share * whole.size()));
    ExpectRefused("cut.db3", {"cut.db3: "});
  }
}

TEST_F(Ros2BagTest, RefusesMessagesThatEndTooEarly) {
  Database database(folder_ / "a.db3");
  database.WriteFrames(0, kBagFrames);
  database.Execute("UPDATE messages SET data = substr(data, 1, 60) WHERE id=8");
  ExpectRefused("a.db3", {"a.db3: /camera", "image_raw: ", "ends too early"});
}

}  // namespace
}  // namespace rgbd_pose
