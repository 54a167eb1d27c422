// Recordings written by the format's own library (mcap/make_fixtures.mjs),
// intact and damaged.

#include <random>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "frontend/bags/bag_reader.h"
#include "tests/frontend/bags/bag_fixture.h"

namespace rgbd_pose {
namespace {

constexpr int kFrames = 12;
const std::vector<std::string> kFiles = {"ros1_lz4", "ros2_lz4_no_summary",
                                         "ros2_no_chunks", "ros2_zstd"};

class McapFileTest : public BagTest {
 protected:
  static std::string PathOf(const std::string& name) {
    return std::string(RGBD_POSE_MCAP) + "/" + name + ".mcap";
  }
  static std::string Bytes(const std::string& name) {
    return ReadTextFile(PathOf(name));
  }
  SourceOptions Write(const std::string& name, const std::string& bytes) {
    folder_.Write(name, bytes);
    return OptionsFor(name);
  }
  static std::string Replace(std::string text, const std::string& from,
                             const std::string& to) {
    size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos);
    for (; at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
    return text;
  }
};

TEST_F(McapFileTest, ReadsWhatItsOwnLibraryWrites) {
  for (const std::string& name : kFiles) {
    SCOPED_TRACE(name);
    SourceOptions options;
    options.path = PathOf(name);
    ExpectFrames(OpenSource("auto", options).get(), kFrames);
  }
}

TEST_F(McapFileTest, ReadsAFolderOfRosbag2) {
  folder_.Write("bag/metadata.yaml", "rosbag2_bagfile_information:\n");
  Write("bag/bag_0.mcap", Bytes("ros2_zstd"));
  const SourceOptions options = OptionsFor("bag");
  ExpectFrames(OpenSource("auto", options).get(), kFrames);
  Write("bag/bag_1.mcap", Bytes("ros1_lz4"));
  ExpectRefusedSource(options, {"bag_1.mcap", "a different ROS version"});
}

TEST_F(McapFileTest, FirstMessagesDoNotDisturbTheOrder) {
  const auto bag = OpenMcapFile(PathOf("ros2_zstd"));
  ASSERT_EQ(bag->topics().size(), 3u);
  std::vector<std::string> all;
  for (const BagTopic& topic : bag->topics()) all.push_back(topic.name);
  const auto next = bag->MessagesOf(all);
  double last = 0.0;
  int count = 0;
  while (const auto message = next()) {
    EXPECT_LE(last, message->received);
    last = message->received;
    ++count;
    EXPECT_EQ(bag->First(message->topic, 1).size(), 1u);
  }
  EXPECT_EQ(count, 1 + 2 * kFrames);
  EXPECT_EQ(bag->First(all[1], 5).size(), 5u);
  EXPECT_EQ(bag->First(all[0], 5).size(), 1u);
}

// Everything before the damage is read; then the error is reported.
TEST_F(McapFileTest, KeepsWhatCameBeforeACut) {
  for (const std::string& name : kFiles) {
    const std::string bytes = Bytes(name);
    const auto source = OpenSource(
        "auto", Write("cut.mcap", bytes.substr(0, bytes.size() * 55 / 100)));
    int frames = 0;
    ExpectInputError(
        [&] {
          while (source->Next().has_value()) ++frames;
        },
        {"cut.mcap: is cut off", "mcap recover"});
    EXPECT_GE(frames, 1) << name;
    EXPECT_LT(frames, kFrames) << name;
    EXPECT_FALSE(source->Next().has_value()) << name;
  }
}

TEST_F(McapFileTest, SaysWhatItDoesNotRead) {
  ExpectRefusedSource(Write("a.mcap", ""), {"a.mcap: is empty"});
  ExpectRefusedSource(Write("a.mcap", "no messages"), {"is not an mcap file"});
  const std::string text("\x03\0\0\0cdr", 7), other("\x03\0\0\0txt", 7);
  ExpectRefusedSource(
      Write("a.mcap", Replace(Bytes("ros2_no_chunks"), text, other)),
      {"a.mcap: has messages encoded as txt; only those of ROS"});
  const std::string lz4("\x03\0\0\0lz4", 7), lz9("\x03\0\0\0lz9", 7);
  ExpectRefusedSource(
      Write("a.mcap", Replace(Bytes("ros1_lz4"), lz4, lz9)),
      {"a.mcap: is compressed with 'lz9'", "zstd, lz4 and bz2"});
}

#ifdef RGBD_POSE_HAS_LIBDEFLATE
// Pixels that are stored uncompressed can be damaged without looking wrong.
TEST_F(McapFileTest, ADamagedChunkIsNotRead) {
  constexpr size_t kBegin = 1160, kEnd = 1640;  // in its second chunk
  const std::string whole = Bytes("ros1_lz4");
  int seen_by_checksum = 0;
  for (size_t at = kBegin; at < kEnd; at += 8) {
    std::string bytes = whole;
    bytes[at] ^= 1;
    const SourceOptions options = Write("a.mcap", bytes);
    const auto source = OpenSource("auto", options);
    try {
      while (source->Next().has_value()) continue;
      // The damaged byte has no effect on the decompressed data.
      ExpectFrames(OpenSource("auto", options).get(), kFrames);
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_NE(what.find("it is damaged: copy it again"), what.npos);
      seen_by_checksum += what.find("does not match its checksum") != what.npos;
    }
  }
  EXPECT_GT(seen_by_checksum, 10);
}
#endif

// Whichever byte is changed, the result is frames or an error of one line.
TEST_F(McapFileTest, NoByteBringsItDown) {
  std::mt19937 random(1);
  int refused = 0;
  for (const std::string& name : kFiles) {
    const std::string whole = Bytes(name);
    for (int i = 0; i < 150; ++i) {
      std::string bytes = whole;
      const size_t most = std::min<size_t>(bytes.size(), 4000);
      bytes[random() % most] = static_cast<char>(random());
      try {
        const auto source = OpenSource("auto", Write("a.mcap", bytes));
        while (const auto next = source->Next()) next->read();
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace rgbd_pose
