#include "frontend/sources/image_pairing.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/evaluation/association.h"
#include "core/util/counter_random.h"

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
      pairs.push_back({pair->color.stamp, pair->depth.stamp});
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
    // Two cameras of almost the same rate, whose stamps jitter and of which
    // some images are missing.
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

TEST(ImagePairingTest, WaitsForAFewImagesOnly) {
  ImagePairing pairing(kMaxDifference);
  for (int k = 0; k < 1000; ++k) {
    const auto message = std::make_shared<std::string>();
    const std::weak_ptr<std::string> is_kept = message;
    EXPECT_TRUE(pairing.AddColor({k * 0.033, message}));
    EXPECT_FALSE(pairing.Take().has_value());
    EXPECT_EQ(pairing.unmatched_color(),
              std::max(0, k + 1 - ImagePairing::kMaxWaiting));
  }
  // Of depth alone nothing can be said; the oldest are let go.
  ImagePairing depth_alone(kMaxDifference);
  std::vector<std::weak_ptr<std::string>> kept;
  for (int k = 0; k < 1000; ++k) {
    const auto message = std::make_shared<std::string>();
    kept.push_back(message);
    depth_alone.AddDepth({k * 0.033, message});
  }
  int count = 0;
  for (const auto& message : kept) count += message.expired() ? 0 : 1;
  EXPECT_EQ(count, ImagePairing::kMaxWaiting);
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

}  // namespace
}  // namespace rgbd_pose
