#include "apps/view/view_state.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

constexpr std::chrono::milliseconds kNow(0);

TEST(ViewStateTest, AReaderGetsEachThingOnceAndLongHistoriesInParts) {
  ViewState state;
  ViewNews first;
  first.frames.resize(5000);
  first.poses[7] = Rigid3d();
  state.Add(first);
  ViewCursor cursor;
  ViewNews news = state.Next(kNow, &cursor);
  const size_t part = news.frames.size();
  EXPECT_LT(part, 5000U);
  EXPECT_EQ(news.poses.size(), 1U);
  state.Finish("here");
  size_t frames = part;
  while (!news.is_finished) {
    news = state.Next(kNow, &cursor);
    ASSERT_TRUE(!news.frames.empty() || news.is_finished);
    EXPECT_TRUE(news.poses.empty());
    frames += news.frames.size();
  }
  EXPECT_EQ(frames, 5000U);
  EXPECT_EQ(news.results, "here");
}

TEST(ViewStateTest, OldPointsAreThinnedSoThatThereIsRoomForNewOnes) {
  ViewState state;
  const std::string points(2000 * kViewPointBytes, 'p');
  for (int i = 0; i < 500; ++i) {
    ViewNews news;
    news.keyframes.push_back({i, points});
    state.Add(news);
  }
  ViewCursor cursor;
  size_t kept = 0, keyframes = 0;
  while (keyframes < 500) {
    for (const ViewKeyframe& keyframe : state.Next(kNow, &cursor).keyframes) {
      ++keyframes;
      EXPECT_GT(keyframe.points.size(), 0U);
      kept += keyframe.points.size() / kViewPointBytes;
    }
  }
  EXPECT_LE(kept, 200000U);
  EXPECT_GT(kept, 80000U);
}

}  // namespace
}  // namespace rgbd_pose
