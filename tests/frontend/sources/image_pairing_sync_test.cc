#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "frontend/sources/image_pairing.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kMaxDifference = 0.01;
constexpr std::chrono::milliseconds kPatience(50);

StreamImage Color(double stamp) { return {true, stamp, cv::Mat()}; }
StreamImage Depth(double stamp) { return {false, stamp, cv::Mat()}; }

// Returns the images of a list, then repeats the last one.
class Images {
 public:
  explicit Images(std::vector<StreamImage> images)
      : images_(std::move(images)) {}
  StreamImage operator()() {
    if (next_ + 1 < images_.size()) return images_[next_++];
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return images_.back();
  }

 private:
  std::vector<StreamImage> images_;
  size_t next_ = 0;
};

TEST(ApproximateTimeSyncTest, PairsWhatIsNear) {
  ApproximateTimeSync pairing(kMaxDifference, kPatience);
  Images images({Depth(0.98), Color(1.0), Depth(1.005), Color(1.03),
                 Color(1.06), Depth(1.058), Depth(2.0)});
  const auto read = [&] { return images(); };
  PairedImages<StreamImage> pair = pairing.Next("it", read);
  EXPECT_EQ(pair.color.stamp, 1.0);
  EXPECT_EQ(pair.depth.stamp, 1.005);
  EXPECT_EQ(pairing.unmatched_color(), 0);
  pair = pairing.Next("it", read);
  EXPECT_EQ(pair.color.stamp, 1.06);
  EXPECT_EQ(pair.depth.stamp, 1.058);
  EXPECT_EQ(pairing.unmatched_color(), 1);
}

TEST(ApproximateTimeSyncTest, SaysThatAStreamStalls) {
  ApproximateTimeSync pairing(kMaxDifference, kPatience);
  Images colors({Color(1.0), Depth(1.0), Color(2.0)});
  const auto read = [&] { return colors(); };
  pairing.Next("it", read);
  ExpectInputError([&] { pairing.Next("it", read); },
                   {"it: sent colour images for 0.05 s", "does the camera"});
  Images depths({Depth(3.0)});
  ExpectInputError([&] { pairing.Next("it", [&] { return depths(); }); },
                   {"it: sent depth images for 0.05 s"});
}

TEST(ApproximateTimeSyncTest, SaysThatAClockRestarted) {
  ApproximateTimeSync pairing(kMaxDifference, kPatience);
  Images images({Color(9.0), Depth(9.0), Color(0.0), Depth(0.0)});
  const auto read = [&] { return images(); };
  pairing.Next("it", read);
  ExpectInputError([&] { pairing.Next("it", read); },
                   {"no colour and depth images"});
}

}  // namespace
}  // namespace rgbd_pose
