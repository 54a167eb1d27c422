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

const Camera kSmallCamera = {160, 120, 100, 100, 80, 60, 0, 0, 0};

// A grey wall without depth.
Frame GreyFrame() {
  Frame frame;
  frame.gray = cv::Mat(120, 160, CV_8UC1, cv::Scalar(77));
  frame.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(0));
  return frame;
}

TEST(ViewPointsTest, PointsLieWhereTheCameraSeesThem) {
  Frame frame = GreyFrame();
  EXPECT_EQ(SamplePoints(frame, {}, kSmallCamera), "");  // no depth is measured
  frame.depth.setTo(10000);                              // 2 m
  const std::string bytes = SamplePoints(frame, {}, kSmallCamera);
  ASSERT_GT(bytes.size(), 1000 * kViewPointBytes);
  ASSERT_EQ(bytes.size() % kViewPointBytes, 0U);
  double sum = 0.0;
  int left = 0;
  const size_t points = bytes.size() / kViewPointBytes;
  for (size_t i = 0; i < points; ++i) {
    const auto number = [&](size_t at) {
      const auto* b = reinterpret_cast<const uint8_t*>(
          bytes.data() + i * kViewPointBytes + at);
      return static_cast<int16_t>(b[0] | b[1] << 8);
    };
    EXPECT_EQ(number(4), 2000);
    EXPECT_LE(std::abs(number(0)), 1600);  // 80 px at f = 100 px and 2 m
    EXPECT_LE(std::abs(number(2)), 1200);
    EXPECT_EQ(bytes.substr(i * kViewPointBytes + 6, 3), "MMM");  // grey 77
    sum += number(0);
    if (i < points / 8) left += number(0) < 0;
  }
  EXPECT_NEAR(sum / static_cast<double>(points), 0.0, 20.0);
  // The first points are spread over the whole image.
  EXPECT_NEAR(left / (points / 8.0), 0.5, 0.15);
}

TEST(ViewPointsTest, PointsHaveTheColoursOfTheirPixels) {
  Frame frame = GreyFrame();
  frame.depth.setTo(10000);
  const cv::Mat color(120, 160, CV_8UC3, cv::Scalar('b', 'g', 'r'));
  const std::string bytes = SamplePoints(frame, color, kSmallCamera);
  ASSERT_GT(bytes.size(), 1000 * kViewPointBytes);
  for (size_t at = 6; at < bytes.size(); at += kViewPointBytes) {
    ASSERT_EQ(bytes.substr(at, 3), "rgb");
  }
}

// Rows that are exposed late see a turning camera's image moved on.
TEST(ViewPointsTest, MatchesLieWhereTheirRowsWereExposed) {
  Frame frame;
  frame.color_shutter = {0.0, 0.1};
  frame.twist = Twist{{0.0, 1.0, 0.0}, {0.0, 0.0, 0.0}};
  Correspondences matches(kSmallCamera);
  ASSERT_TRUE(matches.Add({80, 60, 2.0, 0.5, 0.01}, {80, 60, 2.0, 0.5, 0.01}));
  ASSERT_TRUE(matches.Add({80, 60, 2.0, 0.5, 0.01}, {80, 110, 2.0, 0.5, 0.01}));
  const auto moves = MatchesInImage(frame, kSmallCamera, matches, {0.5, 1.0});
  ASSERT_EQ(moves.size(), 2U);
  const double late = frame.color_shutter.RowTime(110.0, kSmallCamera.height);
  EXPECT_GT(late, 0.04);
  EXPECT_NEAR(moves[0][2], 80.0, 0.1);
  EXPECT_NEAR(moves[1][2], 80.0 - 100.0 * late, 0.5);
  EXPECT_NEAR(moves[1][3], 110.0, 0.5);
  EXPECT_EQ(moves[1][4], 1.0F);
  EXPECT_EQ(MatchesInImage(frame, kSmallCamera, matches, {})[0][4], -1.0F);
}

}  // namespace
}  // namespace rgbd_pose
