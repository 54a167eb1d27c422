#include "frontend/tracking/keyframes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

namespace rgbd_pose {
namespace {

const Camera kCamera = {640, 480, 525, 525, 319.5, 239.5, 0, 0, 0};
constexpr double kMinShare = 0.7;
constexpr double kMaxFlowPx = 30.0;

// A camera that looks along z from a place on the x axis (m).
Rigid3d CameraAt(double x) {
  return Rigid3d(Eigen::Quaterniond::Identity(), {x, 0.0, 0.0});
}

Keyframe MakeKeyframe(int index, int segment, double x) {
  auto features = std::make_unique<FeatureSet>();
  for (int v = 40; v < 480; v += 40) {
    for (int u = 40; u < 640; u += 40) {
      features->observations.push_back({1.0 * u, 1.0 * v, 2.0, 0.5, 0.01});
    }
  }
  const FeatureTrust trust(features->observations.size());
  return {index, segment, CameraAt(x), std::move(features), trust};
}

TEST(KeyframesTest, FindsByIndexAndForgetsTheOldest) {
  Keyframes keyframes(kCamera);
  Keyframe* const second = [&] {
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

TEST(KeyframesTest, TheNearestIsTheOneWithTheSmallestFlow) {
  Keyframes keyframes(kCamera);
  // 525 px / 2 m: a centimetre is 2.6 px.
  Keyframe* const far = keyframes.Add(MakeKeyframe(0, 0, 0.10));
  Keyframe* const near = keyframes.Add(MakeKeyframe(1, 0, -0.03));
  keyframes.Add(MakeKeyframe(2, 0, 0.12));
  const auto nearest = [&](int segment, const Keyframe* except, double flow) {
    return keyframes.FindNearest(CameraAt(0.0), segment, kMinShare, flow,
                                 except);
  };
  EXPECT_EQ(nearest(0, nullptr, kMaxFlowPx), near);
  EXPECT_EQ(nearest(0, near, kMaxFlowPx), far);
  EXPECT_EQ(nearest(0, near, 26.0), nullptr) << "0.10 m are 26.25 px";
  EXPECT_EQ(nearest(1, nullptr, kMaxFlowPx), nullptr) << "another segment";
}

TEST(KeyframesTest, FeaturesHaveToBeInView) {
  Keyframes keyframes(kCamera);
  keyframes.Add(MakeKeyframe(0, 0, 1.0));
  constexpr double kAnyFlow = 1e9;
  // A metre is 262 px: 9 of the 15 columns are left.
  EXPECT_NE(keyframes.FindNearest(CameraAt(0.0), 0, 0.55, kAnyFlow, nullptr),
            nullptr);
  EXPECT_EQ(keyframes.FindNearest(CameraAt(0.0), 0, 0.65, kAnyFlow, nullptr),
            nullptr);
  // Behind the camera nothing is in view.
  const Rigid3d turned(
      Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY())),
      {1.0, 0.0, 0.0});
  EXPECT_EQ(keyframes.FindNearest(turned, 0, 0.01, kAnyFlow, nullptr), nullptr);
}

}  // namespace
}  // namespace rgbd_pose
