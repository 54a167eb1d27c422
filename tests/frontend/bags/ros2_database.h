#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "frontend/bags/cdr_writer.h"
#include "tests/frontend/bags/bag_fixture.h"

namespace rgbd_pose {

// A database with the tables of rosbag2, written with sqlite3.
class Ros2Database {
 public:
  static constexpr char kColor[] = "/camera/color/image_raw";
  static constexpr char kDepth[] = "/camera/aligned_depth_to_color/image_raw";
  static constexpr char kOptical[] = "color_optical";

  explicit Ros2Database(const std::string& path) {
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
  ~Ros2Database() { sqlite3_close(database_); }
  Ros2Database(const Ros2Database&) = delete;
  Ros2Database& operator=(const Ros2Database&) = delete;

  // Compresses each message; empty: no compression.
  std::function<std::string(const std::string&)> pack;

  void Execute(const std::string& query) {
    EXPECT_EQ(sqlite3_exec(database_, query.c_str(), nullptr, nullptr, nullptr),
              SQLITE_OK)
        << sqlite3_errmsg(database_);
  }

  // Writes a message; creates its topic if it does not exist yet.
  void Write(const std::string& topic, const std::string& type, double received,
             const std::string& said) {
    const std::string message = pack ? pack(said) : said;
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
    writer.Header(BagTest::kStart, kOptical);
    writer.Number<uint32_t>(camera.height).Number<uint32_t>(camera.width);
    writer.Text("plumb_bob").Number<uint32_t>(5).Numbers({0, 0, 0, 0, 0});
    writer.Numbers({camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
    writer.Numbers({1, 0, 0, 0, 1, 0, 0, 0, 1});
    writer.Numbers(
        {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0});
    writer.Number<uint32_t>(0).Number<uint32_t>(0);          // binning
    for (int i = 0; i < 4; ++i) writer.Number<uint32_t>(0);  // region
    writer.Number<uint8_t>(0);
    Write(topic, "sensor_msgs/msg/CameraInfo", BagTest::kStart,
          writer.message());
  }

  void WriteFrames(int first, int last) {
    WriteInfo("/camera/color/camera_info");
    for (int k = first; k < last; ++k) {
      WriteImage(kColor, ColorImage(k), "bgr8", BagTest::StampOf(k));
      WriteImage(kDepth, DepthImage(k), "16UC1", BagTest::StampOf(k) + 0.004);
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

}  // namespace rgbd_pose
