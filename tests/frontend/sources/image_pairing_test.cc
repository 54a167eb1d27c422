#include "frontend/sources/image_pairing.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/counter_random.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kMaxDifference = 0.02;

struct Arrival {
  bool is_color;
  double stamp;
};

struct Stamps {
  double color;
  double depth;
};

// All pairs of a stream.
std::vector<Stamps> PairAll(const std::vector<Arrival>& events,
                            ImagePairing* pairing) {
  std::vector<Stamps> pairs;
  const auto take = [&] {
    while (const auto pair = pairing->Take()) {
      pairs.push_back({pair->color.timestamp, pair->depth.timestamp});
    }
  };
  for (const Arrival& event : events) {
    if (event.is_color) {
      EXPECT_TRUE(pairing->AddColor({event.stamp, nullptr}));
    } else {
      pairing->AddDepth({event.stamp, nullptr});
    }
    take();
  }
  pairing->Finish();
  take();
  return pairs;
}

TEST(ImagePairingTest, PairsAsListsThatAreKnownAsAWhole) {
  for (int trial = 0; trial < 50; ++trial) {
    // Two cameras with almost the same rate, jitter in their stamps, and some
    // missing images.
    std::vector<double> colors;
    std::vector<double> depths;
    std::vector<Arrival> events;
    CounterRandom random(trial);
    const auto uniform = [&random] { return 1e-6 * random.Below(1000000); };
    const double offset = uniform() * 0.033;
    for (uint64_t k = 1; k < 300; ++k) {
      if (uniform() > 0.1) {
        colors.push_back(k * 0.0333 + 0.003 * uniform());
        events.push_back({true, colors.back()});
      }
      if (uniform() > 0.1) {
        depths.push_back(k * 0.0334 + offset + 0.003 * uniform());
        events.push_back({false, depths.back()});
      }
    }
    ImagePairing pairing(kMaxDifference);
    const std::vector<Stamps> pairs = PairAll(events, &pairing);
    const std::vector<IndexPair> expected =
        Associate(colors, depths, kMaxDifference);
    ASSERT_EQ(pairs.size(), expected.size()) << trial;
    for (size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_EQ(pairs[i].color, colors[expected[i].first]);
      EXPECT_EQ(pairs[i].depth, depths[expected[i].second]);
    }
    EXPECT_EQ(pairing.unmatched_color(),
              static_cast<int>(colors.size() - expected.size()));
  }
}

// The waiting images are limited by time and by memory.
TEST(ImagePairingTest, WaitsForSomeImagesOnly) {
  constexpr double kInterval = 1.0 / 32;  // s
  constexpr size_t kLarge = size_t{4} << 20;
  constexpr int kMaxLarge = ImagePairing::kMaxBytes / kLarge;
  constexpr int kMaxWaiting = ImagePairing::kMaxSeconds / kInterval + 1;
  ImagePairing pairing(kMaxDifference);
  for (int k = 0; k < 1500; ++k) {
    EXPECT_TRUE(pairing.AddColor({k * kInterval, nullptr}));
    EXPECT_FALSE(pairing.Take().has_value());
    EXPECT_EQ(pairing.unmatched_color(), std::max(0, k + 1 - kMaxWaiting));
  }
  ImagePairing large(kMaxDifference);
  const auto message = std::make_shared<std::string>(kLarge, ' ');
  for (int k = 0; k < 100; ++k) {
    EXPECT_TRUE(large.AddColor({k * kInterval, message}));
    EXPECT_FALSE(large.Take().has_value());
    EXPECT_EQ(large.unmatched_color(), std::max(0, k + 1 - kMaxLarge));
  }
  // Depth images alone cannot be paired; the oldest are discarded.
  ImagePairing depth_alone(kMaxDifference);
  std::vector<std::weak_ptr<std::string>> kept;
  for (int k = 0; k < 1500; ++k) {
    const auto bytes = std::make_shared<std::string>();
    kept.push_back(bytes);
    depth_alone.AddDepth({k * kInterval, bytes});
  }
  int count = 0;
  for (const auto& bytes : kept) count += bytes.expired() ? 0 : 1;
  EXPECT_EQ(count, kMaxWaiting);
}

TEST(ImagePairingTest, WaitsForDepthThatIsLate) {
  std::vector<Arrival> events;
  for (int k = 0; k < 300; ++k) events.push_back({true, k * 0.033});
  for (int k = 0; k < 300; ++k) events.push_back({false, k * 0.033});
  ImagePairing pairing(kMaxDifference);
  EXPECT_EQ(PairAll(events, &pairing).size(), 300u);
  EXPECT_EQ(pairing.late(), 0);
}

TEST(ImagePairingTest, CountsWhatHasTheSameStamp) {
  std::vector<Arrival> events;
  for (int k = 0; k < 20; ++k) {
    events.push_back({true, 1.0});
    events.push_back({false, 1.0});
  }
  ImagePairing pairing(kMaxDifference);
  EXPECT_EQ(PairAll(events, &pairing).size(), 1u);
  EXPECT_EQ(pairing.same_stamp(), 38);
}

TEST(ImagePairingTest, SortsAndSaysWhatComesTooLate) {
  ImagePairing pairing(kMaxDifference);
  const std::vector<Stamps> pairs = PairAll(
      {{true, 2}, {true, 1}, {false, 1}, {true, 1}, {false, 2}}, &pairing);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].color, 1.0);
  EXPECT_EQ(pairs[1].depth, 2.0);
  EXPECT_FALSE(pairing.AddColor({1.5, nullptr}));
  EXPECT_TRUE(pairing.AddColor({2.0, nullptr})) << "is known already";
  EXPECT_FALSE(pairing.Take().has_value());
}

constexpr double kMaxSyncDifference = 0.01;
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
  ApproximateTimeSync pairing(kMaxSyncDifference, kPatience);
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
  ApproximateTimeSync pairing(kMaxSyncDifference, kPatience);
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
  ApproximateTimeSync pairing(kMaxSyncDifference, kPatience);
  Images images({Color(9.0), Depth(9.0), Color(0.0), Depth(0.0)});
  const auto read = [&] { return images(); };
  pairing.Next("it", read);
  ExpectInputError([&] { pairing.Next("it", read); },
                   {"no colour and depth images"});
}

}  // namespace
}  // namespace rgbd_pose
