// The inertial sensor of ROS 2 bags in both storages.

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/util/format.h"
#include "frontend/bags/bag_reader.h"
#include "tests/frontend/bags/ros2_database.h"

namespace rgbd_pose {
namespace {

constexpr char kImu[] = "/camera/imu";
constexpr int kSamples = 250;
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

class Ros2ImuTest : public BagTest {
 protected:
  void ExpectSamples(const std::string& path, int frames) {
    SourceOptions options;
    options.path = path;
    const auto source = OpenSource("auto", options);
    ASSERT_TRUE(source->imu().has_value());
    std::vector<ImuSample> all;
    int count = 0;
    while (const std::optional<RgbdFrame> next = source->Next()) {
      all.insert(all.end(), next->imu.begin(), next->imu.end());
      ++count;
    }
    EXPECT_EQ(count, frames);
    ASSERT_GT(all.size(), 20u);
    for (size_t k = 0; k < all.size(); ++k) {
      EXPECT_NEAR(all[k].stamp, StampOfSample(static_cast<int>(k)), 1e-6);
      EXPECT_EQ(all[k].gyro, Eigen::Vector3d(0.1 * k, 0.2, 0.3));
      EXPECT_EQ(all[k].accel, Eigen::Vector3d(0.5, -9.8, 0.1));
    }
  }
};

TEST_F(Ros2ImuTest, IsReadFromSqlite) {
  {
    Ros2Database bag(folder_ / "bag.db3");
    bag.WriteFrames(0, 10);
    for (int k = 0; k < kSamples; ++k) {
      bag.Write(kImu, "sensor_msgs/msg/Imu", StampOfSample(k) + 0.005,
                ImuMessage(k));
    }
  }
  ExpectSamples(folder_ / "bag.db3", 10);
}

// Records of an MCAP file: https://mcap.dev/spec
class McapText {
 public:
  template <typename T>
  McapText& Number(T value) {
    AppendLittleEndian(value, &bytes);
    return *this;
  }
  McapText& Text(const std::string& text) {
    Number(static_cast<uint32_t>(text.size()));
    bytes += text;
    return *this;
  }
  McapText& Record(uint8_t opcode, const McapText& content) {
    Number(opcode).Number(static_cast<uint64_t>(content.bytes.size()));
    bytes += content.bytes;
    return *this;
  }
  std::string bytes;
};

TEST_F(Ros2ImuTest, IsReadFromMcap) {
  const std::string magic("\x89MCAP0\r\n", 8);
  // The messages of images, from a database that is read back.
  {
    Ros2Database bag(folder_ / "images.db3");
    bag.WriteFrames(0, 4);
  }
  const auto images = OpenBagDatabase(folder_ / "images.db3");
  McapText file;
  file.bytes = magic;
  file.Record(0x01, McapText().Text("ros2").Text("test"));
  std::vector<BagTopic> topics = images->topics();
  topics.push_back({kImu, "sensor_msgs/Imu"});
  std::vector<std::string> names;
  for (size_t i = 0; i < topics.size(); ++i) {
    const auto id = static_cast<uint16_t>(i + 1);
    std::string type = topics[i].type;
    type.replace(type.find('/'), 1, "/msg/");
    file.Record(0x03,
                McapText().Number(id).Text(type).Text("ros2msg").Text("any"));
    file.Record(0x04, McapText()
                          .Number(id)
                          .Number(id)
                          .Text(topics[i].name)
                          .Text("cdr")
                          .Number(uint32_t{0}));
    names.push_back(topics[i].name);
  }
  const auto write = [&](const std::string& topic, double received,
                         const std::string& message) {
    size_t i = 0;
    while (names[i] != topic) ++i;
    McapText content;
    const auto time = static_cast<uint64_t>(received * 1e9);
    content.Number(static_cast<uint16_t>(i + 1)).Number(uint32_t{0});
    content.Number(time).Number(time);
    content.bytes += message;
    file.Record(0x05, content);
  };
  const BagReader::Messages next = images->MessagesOf(names);
  int samples = 0;
  while (const std::optional<BagMessage> message = next()) {
    for (; StampOfSample(samples) + 0.005 < message->received; ++samples) {
      write(kImu, StampOfSample(samples) + 0.005, ImuMessage(samples));
    }
    write(message->topic, message->received, *message->bytes);
  }
  for (const int end = samples + 20; samples < end; ++samples) {
    write(kImu, StampOfSample(samples) + 0.005, ImuMessage(samples));
  }
  file.Record(0x0f, McapText().Number(uint32_t{0}));
  file.Record(
      0x02,
      McapText().Number(uint64_t{0}).Number(uint64_t{0}).Number(uint32_t{0}));
  ExpectSamples(folder_.Write("bag.mcap", file.bytes + magic), 4);
}

}  // namespace
}  // namespace rgbd_pose
