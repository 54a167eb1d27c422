#include <bzlib.h>

#include <cstring>
#include <filesystem>

#include "core/util/text_file.h"
#include "frontend/bags/bag_reader.h"
#include "tests/frontend/bags/ros1_bag_fixture.h"
#include "tests/support/expect_input_error.h"

namespace {

int unpacked_chunks = 0;

}  // namespace

// Replaces libbz2's function, with the same behaviour, and counts the calls.
extern "C" int BZ2_bzBuffToBuffDecompress(char* to, unsigned* size, char* from,
                                          unsigned from_size, int small,
                                          int verbosity) {
  ++unpacked_chunks;
  bz_stream stream = {};
  stream.next_in = from;
  stream.avail_in = from_size;
  stream.next_out = to;
  stream.avail_out = *size;
  BZ2_bzDecompressInit(&stream, verbosity, small);
  const int status = BZ2_bzDecompress(&stream);
  *size -= stream.avail_out;
  BZ2_bzDecompressEnd(&stream);
  return status == BZ_STREAM_END ? BZ_OK : status;
}

namespace rgbd_pose {
namespace {

TEST_F(Ros1BagTest, ReadsFrames) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2,
        rosbag::compression::LZ4}) {
    Open(compression);
    WriteAll();
    const auto source = Source();
    ExpectFrames(source.get(), kFrames);
    EXPECT_EQ(source->unmatched_color(), 0);
    EXPECT_TRUE(source->ground_truth().empty());
    EXPECT_TRUE(source->timestamps().empty());
    EXPECT_TRUE(source->remarks().empty()) << "there was no choice of topics";
  }
}

// Chunks of a recorder whose messages arrive in an order different from their
// time stamps.
TEST_F(Ros1BagTest, UnpacksAChunkOnceWhereTheirTimesOverlap) {
  Open(rosbag::compression::BZ2);
  bag_.setChunkThreshold(3000);
  WriteInfo();
  for (int k = 0; k < kFrames + 2; ++k) {
    if (k < kFrames) WriteColor(k);
    if (k >= 2) WriteDepth(k - 2);
  }
  Options();
  int chunks = 0;
  const std::string bytes = ReadTextFile(path_);
  for (size_t at = 0; (at = bytes.find("op=\x05", at)) != bytes.npos; ++at) {
    ++chunks;
  }
  const auto source = Source();
  unpacked_chunks = 0;
  ExpectFrames(source.get(), kFrames);
  EXPECT_GT(chunks, 10);
  EXPECT_LE(unpacked_chunks, chunks);
}

// Named as by `rosbag record --split`: part 10 comes after part 9.
TEST_F(Ros1BagTest, ReadsAFolderOfParts) {
  const std::string folder = folder_ / "walk";
  std::filesystem::create_directories(folder);
  for (int k = 0; k < kFrames; ++k) {
    path_ = folder + "/walk_" + std::to_string(k) + (k > 0 ? ".bag" : ".BAG");
    Open();
    if (k % 2 == 0) WriteInfo();
    WriteColor(k);
    WriteDepth(k);
    bag_.close();
  }
  path_ = folder;
  ExpectFrames(Source().get(), kFrames);

  path_ = folder + "/walk_20.bag";
  Open();
  Camera other = SmallCamera().camera;
  other.fx += 1.0;
  Write("/camera/rgb/camera_info", kStart + 9, MakeInfo(other));
  bag_.close();
  path_ = folder;
  ExpectRefused({"walk_20.bag: /camera/rgb/camera_info: ", "different camera"});

  // Two recordings in one folder.
  std::filesystem::rename(folder + "/walk_20.bag", folder + "/sit_1.bag");
  ExpectRefused({"walk: ", "one at a time"});
}

TEST_F(Ros1BagTest, RefusesDamagedBags) {
  Open();
  WriteAll();
  Options();
  const std::string whole = ReadTextFile(path_);
  for (const double share : {0.0, 0.0001, 0.999}) {
    folder_.Write("a.bag", whole.substr(0, share * whole.size()));
    ExpectRefused({"a.bag: "});
  }
  // The time of the last chunk and its list of topics.
  for (const int place : {60, 8}) {
    std::string damaged = whole;
    damaged.replace(whole.size() - place, 8, std::string(8, '\xff'));
    folder_.Write("a.bag", damaged);
    ExpectRefused({"a.bag: ", "damaged"});
  }

  folder_.Write("a.bag", "no bag at all, but a text of some length");
  ExpectRefused({"a.bag: ", "ROS 1 bag"});
}

// A killed recorder leaves no index and no position of one.
TEST_F(Ros1BagTest, ReadsUnfinishedBagsUpToTheirEnd) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2,
        rosbag::compression::LZ4}) {
    path_ = folder_ / "a.bag";
    Open(compression);
    bag_.setChunkThreshold(2000);
    WriteAll();
    Options();
    const std::string whole = ReadTextFile(path_);
    const std::string name = "index_pos=";
    const size_t place = whole.find(name) + name.size();
    uint64_t index = 0;
    std::memcpy(&index, whole.data() + place, sizeof(index));
    std::string unfinished = whole.substr(0, index);
    unfinished.replace(place, 8, std::string(8, '\0'));
    // A packed recording as small as this one is a single chunk.
    const bool has_chunks = compression == rosbag::compression::Uncompressed;
    for (const double share : {1.0, has_chunks ? 0.6 : 1.0}) {
      folder_.Write("b.bag.active", unfinished.substr(0, share * index));
      path_ = folder_ / "b.bag.active";
      const auto source = Source();
      int frames = 0;
      ExpectInputError(
          [&] {
            while (source->Next().has_value()) ++frames;
          },
          {"b.bag.active: ends without its index", "rosbag reindex"});
      EXPECT_LE(frames, share == 1.0 ? kFrames : kFrames - 1);
      EXPECT_GE(frames, share == 1.0 ? kFrames : 1);
      EXPECT_FALSE(source->Next().has_value());
    }
    path_ = folder_ / "b.bag";
    // After a power failure, file systems fill up with zeros.
    folder_.Write("b.bag", unfinished + std::string(5000, '\0'));
    EXPECT_EQ(OpenRos1Bag(path_)->First(kDepth, 100).size(), size_t{kFrames});
    folder_.Write("b.bag", unfinished.substr(0, 4500));
    ExpectRefused({"b.bag: ends before its first messages"});
  }
}

}  // namespace
}  // namespace rgbd_pose
