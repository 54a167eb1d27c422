#include "frontend/places/place_database.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

constexpr int kRows = 300;  // descriptors of a keyframe

cv::Mat RandomDescriptors(int rows, std::mt19937* rng) {
  cv::Mat descriptors(rows, 32, CV_8U);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < 32; ++j) {
      descriptors.at<uchar>(i, j) = static_cast<uchar>((*rng)());
    }
  }
  return descriptors;
}

// The same descriptors from another view: in each, `bits` bits are drawn again
// (half of them keep their value).
cv::Mat SeenAgain(const cv::Mat& descriptors, int bits, std::mt19937* rng) {
  cv::Mat again = descriptors.clone();
  for (int i = 0; i < again.rows; ++i) {
    for (int k = 0; k < bits; ++k) {
      const uint32_t draw = (*rng)();
      const int mask = 1 << (draw & 7);
      uchar& byte = again.at<uchar>(i, (draw >> 3) & 31);
      byte = static_cast<uchar>((draw & 256) != 0 ? byte | mask : byte & ~mask);
    }
  }
  return again;
}

std::vector<cv::Mat> Fill(int keyframes, std::mt19937* rng,
                          PlaceDatabase* index) {
  std::vector<cv::Mat> all;
  for (int k = 0; k < keyframes; ++k) {
    all.push_back(RandomDescriptors(kRows, rng));
    index->Add(k, all.back());
  }
  return all;
}

TEST(PlaceDatabaseTest, FindsWhatIsSeenAgain) {
  std::mt19937 rng(1);
  PlaceDatabase index;
  const std::vector<cv::Mat> all = Fill(100, &rng, &index);
  EXPECT_EQ(index.size(), 100);
  for (const int k : {0, 17, 99}) {
    // A third of the features, with 25 of 256 bits wrong on average.
    cv::Mat frame = RandomDescriptors(kRows, &rng);
    SeenAgain(all[k].rowRange(0, 100), 50, &rng).copyTo(frame.rowRange(0, 100));
    const std::vector<PlaceCandidate> found = index.Query(frame, 3);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found[0].keyframe, k);
    EXPECT_GT(found[0].score, 0.2);
    EXPECT_LE(found[0].score, 0.34);
    if (found.size() > 1) {
      EXPECT_LT(found[1].score, 0.02);
    }
  }
  EXPECT_LE(index.Query(all[3], 1).size(), 1u);
  EXPECT_TRUE(index.Query(all[3], 0).empty());
}

TEST(PlaceDatabaseTest, UnknownPlacesScoreNothing) {
  std::mt19937 rng(2);
  PlaceDatabase index;
  Fill(100, &rng, &index);
  for (const PlaceCandidate& candidate :
       index.Query(RandomDescriptors(kRows, &rng), 3)) {
    EXPECT_LT(candidate.score, 0.02);
  }
  EXPECT_TRUE(PlaceDatabase().Query(RandomDescriptors(kRows, &rng), 3).empty());
}

// Ten keyframes show only a common wallpaper; one also shows something unique.
TEST(PlaceDatabaseTest, WhatIsEverywhereDoesNotWin) {
  std::mt19937 rng(3);
  const cv::Mat wallpaper = RandomDescriptors(250, &rng);
  const cv::Mat own = RandomDescriptors(50, &rng);
  PlaceDatabase index;
  for (int k = 0; k < 10; ++k) {
    index.Add(k, SeenAgain(wallpaper, 10, &rng));
  }
  cv::Mat special;
  cv::vconcat(own, SeenAgain(wallpaper.rowRange(0, 100), 30, &rng), special);
  index.Add(42, special);
  cv::Mat frame;
  cv::vconcat(SeenAgain(own, 30, &rng), SeenAgain(wallpaper, 30, &rng), frame);
  const std::vector<PlaceCandidate> found = index.Query(frame, 2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].keyframe, 42);
  EXPECT_GT(found[0].score, 2.0 * found[1].score);
}

TEST(PlaceDatabaseTest, AsksWhichMayBe) {
  std::mt19937 rng(4);
  PlaceDatabase index;
  const cv::Mat place = RandomDescriptors(kRows, &rng);
  for (int k = 0; k < 6; ++k) index.Add(k, SeenAgain(place, 20, &rng));
  const std::vector<PlaceCandidate> found =
      index.Query(place, 10, [](int keyframe) { return keyframe < 2; });
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(found[0].keyframe + found[1].keyframe, 2);
}

// If a keyframe has too many features, those used are from the whole image.
TEST(PlaceDatabaseTest, TakesFromAllRows) {
  std::mt19937 rng(9);
  PlaceDatabase index;
  std::vector<cv::Mat> all;
  for (int k = 0; k < 20; ++k) {
    all.push_back(RandomDescriptors(2 * PlaceDatabase::kMaxDescriptors, &rng));
    index.Add(k, all.back());
  }
  const int rows = all[7].rows;
  for (const int first : {0, rows - 100}) {
    const std::vector<PlaceCandidate> found =
        index.Query(all[7].rowRange(first, first + 100), 1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].keyframe, 7);
    EXPECT_NEAR(found[0].score, 0.5, 0.05);
  }
}

// A static camera: buckets are full, and the place is still found, in its first
// keyframes.
TEST(PlaceDatabaseTest, OnePlaceManyTimesIsFoundWhereItWasFirst) {
  std::mt19937 rng(5);
  PlaceDatabase index;
  const cv::Mat place = RandomDescriptors(kRows, &rng);
  for (int k = 0; k < 200; ++k) index.Add(k, SeenAgain(place, 4, &rng));
  const std::vector<PlaceCandidate> found = index.Query(place, 1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(found[0].keyframe, 100);
}

TEST(PlaceDatabaseTest, ForgetsWhatIsRemoved) {
  std::mt19937 rng(6);
  PlaceDatabase index;
  const std::vector<cv::Mat> all = Fill(60, &rng, &index);
  for (int k = 0; k < 60; ++k) {
    if (k % 3 != 0) index.Remove(k);
  }
  index.Remove(1000);  // does not exist
  EXPECT_EQ(index.size(), 20);
  for (const int k : {1, 30}) {
    const std::vector<PlaceCandidate> found =
        index.Query(SeenAgain(all[k], 40, &rng), 1);
    EXPECT_EQ(!found.empty() && found[0].score > 0.1, k % 3 == 0) << k;
  }
  // Free slots are reused.
  for (int k = 100; k < 140; ++k) {
    index.Add(k, RandomDescriptors(kRows, &rng));
  }
  index.Add(1, all[1]);
  const std::vector<PlaceCandidate> found = index.Query(all[1], 1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].keyframe, 1);
}

TEST(PlaceDatabaseTest, TheSameCallsGiveTheSameResults) {
  std::vector<PlaceCandidate> found[2];
  for (std::vector<PlaceCandidate>& result : found) {
    std::mt19937 rng(7);
    PlaceDatabase index;
    const cv::Mat place = RandomDescriptors(kRows, &rng);
    for (int k = 0; k < 20; ++k) index.Add(k, SeenAgain(place, 60, &rng));
    result = index.Query(place, 20);
  }
  ASSERT_EQ(found[0].size(), 20u);
  for (size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(found[0][i].keyframe, found[1][i].keyframe);
    EXPECT_EQ(found[0][i].score, found[1][i].score);
    EXPECT_LE(found[0][i].score, found[0][std::max<size_t>(i, 1) - 1].score);
  }
}

TEST(PlaceDatabaseTest, RefusesWhatIsNoOrb) {
  std::mt19937 rng(8);
  PlaceDatabase index;
  index.Add(1, RandomDescriptors(10, &rng));
  index.Add(2, cv::Mat());  // a black image has no features
  ExpectInputError([&] { index.Add(1, cv::Mat()); }, {"keyframe 1"});
  const cv::Mat sift(10, 128, CV_8U, cv::Scalar(0));
  ExpectInputError([&] { index.Add(3, sift); }, {"128"});
  ExpectInputError([&] { index.Query(sift, 1); }, {"128"});
  EXPECT_TRUE(index.Query(cv::Mat(), 1).empty());
}

}  // namespace
}  // namespace rgbd_pose
