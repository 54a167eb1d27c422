#include "frontend/tracking/keyframes.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/support/feature_wall.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

std::unique_ptr<Reference> MakeWall() {
  auto reference = std::make_unique<Reference>();
  reference->features = std::make_unique<ReferenceFeatures>(FeatureWall());
  return reference;
}

constexpr double kMinShare = 0.7;
constexpr double kMaxFlowPx = 30.0;

// Its camera looks along z from a position on the x axis (m).
OdometryKeyframe MakeKeyframe(int id, int segment, double x) {
  return {{id, segment, Moved(x, 0.0, 0.0)}, MakeWall()};
}

TEST(KeyframesTest, FindsByIdAndForgetsTheOldest) {
  Keyframes keyframes;
  OdometryKeyframe* const second = [&] {
    keyframes.Add(MakeKeyframe(0, 0, 0.0));
    return keyframes.Add(MakeKeyframe(1, 0, 0.0));
  }();
  for (int i = 2; i <= static_cast<int>(Keyframes::kMaxKeyframes); ++i) {
    keyframes.Add(MakeKeyframe(i, 0, 0.0));
  }
  EXPECT_EQ(keyframes.Find(0), nullptr);
  EXPECT_EQ(keyframes.Find(1), second) << "moved";
  EXPECT_EQ(keyframes.Find(99), nullptr);
}

TEST(KeyframesTest, ThoseOfEarlierSegmentsComeTheLatestFirst) {
  Keyframes keyframes;
  std::vector<Keyframe*> expected;
  for (int i = 0; i < static_cast<int>(Keyframes::kMaxKeyframes) + 3; ++i) {
    expected.insert(expected.begin(),
                    keyframes.Add(MakeKeyframe(i, i / 10, 0.0)));
  }
  expected.resize(Keyframes::kMaxKeyframes);
  EXPECT_EQ(keyframes.Before(3), expected);
  expected.erase(expected.begin(), expected.begin() + 3);  // those of segment 2
  EXPECT_EQ(keyframes.Before(2), expected);
}

TEST(KeyframesTest, TheNearestIsTheOneWithTheSmallestFlow) {
  Keyframes keyframes;
  // 525 px / 2 m: a centimetre is 2.6 px.
  OdometryKeyframe* const far = keyframes.Add(MakeKeyframe(0, 0, 0.10));
  OdometryKeyframe* const near = keyframes.Add(MakeKeyframe(1, 0, -0.03));
  keyframes.Add(MakeKeyframe(2, 0, 0.12));
  const auto nearest = [&](int segment, const OdometryKeyframe* except,
                           double flow) {
    return keyframes.FindNearest(Rigid3d(), segment, kMinShare, flow, except);
  };
  EXPECT_EQ(nearest(0, nullptr, kMaxFlowPx), near);
  EXPECT_EQ(nearest(0, near, kMaxFlowPx), far);
  EXPECT_EQ(nearest(0, near, 26.0), nullptr) << "0.10 m are 26.25 px";
  EXPECT_EQ(nearest(1, nullptr, kMaxFlowPx), nullptr) << "another segment";
}

TEST(KeyframesTest, EnoughOfTheViewHasToBeShared) {
  Keyframes keyframes;
  // At 262.5 px per metre, 9 of the 15 columns are left.
  keyframes.Add(MakeKeyframe(0, 0, 1.0));
  constexpr double kAnyFlow = 1e9;
  EXPECT_NE(keyframes.FindNearest(Rigid3d(), 0, 0.55, kAnyFlow, nullptr),
            nullptr);
  EXPECT_EQ(keyframes.FindNearest(Rigid3d(), 0, 0.65, kAnyFlow, nullptr),
            nullptr);
}

}  // namespace
}  // namespace rgbd_pose
