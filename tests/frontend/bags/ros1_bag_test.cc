#include "frontend/bags/ros1_bag.h"

#include "core/util/text_file.h"
#include "tests/frontend/bags/ros1_bag_fixture.h"

namespace rgbd_pose {
namespace {

TEST_F(Ros1BagTest, ReadsFrames) {
  Open();
  WriteAll();
  const auto source = Source();
  ExpectFrames(source.get(), kFrames);
  EXPECT_EQ(source->unmatched_color(), 0);
  EXPECT_TRUE(source->ground_truth().empty());
  EXPECT_TRUE(source->timestamps().empty());
}

TEST_F(Ros1BagTest, ReadsPackedOnes) {
  for (const auto compression :
       {rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    Open(compression);
    WriteAll();
    ExpectFrames(Source().get(), kFrames);
  }
}

TEST_F(Ros1BagTest, RefusesDamagedBags) {
  Open();
  WriteAll();
  Options();
  const std::string whole = ReadTextFile(path_);
  for (const double share : {0.0, 0.0001, 0.3, 0.9, 0.999}) {
    folder_.Write("a.bag", whole.substr(0, share * whole.size()));
    ExpectRefused({"a.bag: "});
  }
  // The library does not print by itself.
  std::string damaged = whole;
  damaged.replace(whole.size() - 40, 8, std::string(8, '\xff'));
  folder_.Write("a.bag", damaged);
  testing::internal::CaptureStderr();
  ExpectRefused({"a.bag: ", "damaged"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");

  folder_.Write("a.bag", "no bag at all, but a text of some length");
  ExpectRefused({"a.bag: ", "ROS 1 bag"});

  // Its recorder was killed: nothing says where the index is.
  std::string unindexed = whole;
  const std::string name = "index_pos=";
  const size_t place = unindexed.find(name);
  ASSERT_NE(place, std::string::npos);
  unindexed.replace(place + name.size(), 8, std::string(8, '\0'));
  folder_.Write("a.bag", unindexed);
  ExpectRefused({"a.bag: has no index", "rosbag reindex"});
}

}  // namespace
}  // namespace rgbd_pose
