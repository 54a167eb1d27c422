#include "frontend/places/relocaliser.h"

#include <gtest/gtest.h>

#include <deque>
#include <optional>
#include <vector>

#include "core/util/units.h"
#include "tests/support/motions.h"
#include "tests/support/track_sequence.h"

namespace rgbd_pose {
namespace {

// Good enough to start tracking: a fraction of the depth and of a view's width.
constexpr double kMaxTranslationError = 0.03;
constexpr double kMaxRotationError = 1.0 * kRadiansPerDegree;

// Frames of the simulated room from any camera pose.
class FurnishedRoom {
 public:
  explicit FurnishedRoom(uint32_t seed) { options_.seed = seed; }

  const Camera& camera() const { return options_.camera.camera; }

  // The view from `start_from_cam`, relative to the start of the paths. Each
  // has noise of its own.
  Frame See(const Rigid3d& start_from_cam) {
    options_.path_from_cam = start_from_cam;
    return SyntheticDataset(options_).Read(count_++);
  }

 private:
  SyntheticOptions options_ = RoomOptions("still", 1000);
  int count_ = 0;
};

Rigid3d TurnedBy(double degrees) {
  return Turned(degrees * kRadiansPerDegree, Eigen::Vector3d::UnitY());
}

// A relocaliser with the keyframes to search.
class Search {
 public:
  explicit Search(const Camera& camera) : relocaliser_({camera}) {}

  void Add(const Frame& keyframe, int id) {
    kept_.push_front({id, 0, Rigid3d(), PreparedFrame(keyframe)});
  }
  void ForgetTheOldest() { kept_.pop_back(); }
  std::optional<Relocalisation> Find(const Frame& frame) {
    std::vector<Keyframe*> keyframes;
    for (Keyframe& keyframe : kept_) keyframes.push_back(&keyframe);
    return relocaliser_.Find(PreparedFrame(frame), keyframes);
  }

 private:
  Relocaliser relocaliser_;
  std::deque<Keyframe> kept_;
};

void ExpectFound(const std::optional<Relocalisation>& found,
                 const Rigid3d& cur_from_keyframe) {
  ASSERT_TRUE(found.has_value());
  EXPECT_GE(found->inliers, 15);
  const Rigid3d error = found->cur_from_keyframe * cur_from_keyframe.Inverse();
  EXPECT_LE(error.Angle(), kMaxRotationError);
  EXPECT_LE(error.translation.norm(), kMaxTranslationError);
}

TEST(RelocaliserTest, FindsThePlaceFromAnotherPose) {
  FurnishedRoom room(1);
  Search relocaliser(room.camera());
  relocaliser.Add(room.See(Rigid3d()), 42);
  for (const Rigid3d& pose :
       {Rigid3d(), TurnedBy(25.0), TurnedBy(-25.0), Moved(0.3, 0.0, 0.0),
        Moved(0.0, 0.0, 0.3), Moved(-0.2, 0.1, -0.2) * TurnedBy(10.0)}) {
    const std::optional<Relocalisation> found =
        relocaliser.Find(room.See(pose));
    ExpectFound(found, pose.Inverse());
    EXPECT_EQ(found->keyframe, 42);
  }
}

// Each search describes two of the twenty. While lost frames start segments,
// there is one more keyframe in each search.
TEST(RelocaliserTest, FindsOldKeyframesAfterSomeSearches) {
  FurnishedRoom room(1);
  const Frame elsewhere = room.See(TurnedBy(180.0));
  const Frame frame = room.See(Moved(0.1, 0.0, 0.0));
  for (const bool are_added : {false, true}) {
    Search relocaliser(room.camera());
    relocaliser.Add(room.See(Rigid3d()), 7);
    for (int i = 0; i < 19; ++i) relocaliser.Add(elsewhere, 100 + i);
    std::optional<Relocalisation> found;
    for (int i = 0; i < (are_added ? 30 : 10) && !found; ++i) {
      if (are_added) relocaliser.Add(elsewhere, 200 + i);
      found = relocaliser.Find(frame);
    }
    ExpectFound(found, Moved(-0.1, 0.0, 0.0));
    EXPECT_EQ(found->keyframe, 7);
  }
}

// Views in all directions, of which the index selects a few candidates.
TEST(RelocaliserTest, FindsAFrameInTheWholeMap) {
  FurnishedRoom room(1);
  const Relocaliser relocaliser({room.camera()});
  PlaceDatabase index;
  std::vector<PlaceFeatures> map;
  const auto features_of = [&](int id) -> const PlaceFeatures& {
    return map[id];
  };
  for (int i = 0; i < 12; ++i) {
    map.push_back(DescribeKeyframe(PreparedFrame(room.See(TurnedBy(30.0 * i))),
                                   {room.camera()}));
    index.Add(i, map.back().described.descriptors);
  }
  for (const int i : {0, 1, 5, 11}) {
    const Rigid3d pose =
        TurnedBy(30.0 * i) * Moved(0.1, 0.0, 0.1) * TurnedBy(5.0);
    const std::optional<Relocalisation> found = relocaliser.FindInMap(
        PreparedFrame(room.See(pose)), index, features_of);
    ASSERT_TRUE(found.has_value()) << i;
    ExpectFound(found, pose.Inverse() * TurnedBy(30.0 * found->keyframe));
  }
  FurnishedRoom other(2);
  EXPECT_FALSE(relocaliser.FindInMap(PreparedFrame(other.See(TurnedBy(10.0))),
                                     index, features_of));
}

TEST(RelocaliserTest, LooksOnlyAmongTheKeyframesThatAreKept) {
  FurnishedRoom room(1);
  Search relocaliser(room.camera());
  const Frame place = room.See(Rigid3d());
  relocaliser.Add(place, 7);
  const Frame elsewhere = room.See(TurnedBy(180.0));
  for (int i = 0; i < 5; ++i) relocaliser.Add(elsewhere, 100 + i);
  // The searches have come to the last keyframe when it is forgotten.
  const Frame nowhere = FurnishedRoom(2).See(TurnedBy(90.0));
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(relocaliser.Find(nowhere));
  relocaliser.ForgetTheOldest();
  relocaliser.ForgetTheOldest();
  for (int i = 0; i < 6; ++i) EXPECT_FALSE(relocaliser.Find(place));
}

TEST(RelocaliserTest, FindsNothingWhereNothingIsSeen) {
  FurnishedRoom room(1);
  const Frame good = room.See(Rigid3d());
  Frame black = good;
  black.gray = cv::Mat(good.gray.size(), CV_8UC1, cv::Scalar(0));
  Frame blind = good;
  blind.depth = cv::Mat(good.depth.size(), CV_16UC1, cv::Scalar(0));

  Search relocaliser(room.camera());
  EXPECT_FALSE(relocaliser.Find(good)) << "without any keyframe";
  relocaliser.Add(black, 1);
  relocaliser.Add(blind, 2);
  EXPECT_FALSE(relocaliser.Find(good));
  relocaliser.Add(good, 3);
  EXPECT_FALSE(relocaliser.Find(black));
  EXPECT_FALSE(relocaliser.Find(blind));
  EXPECT_TRUE(relocaliser.Find(good));
}

// Rooms with the same shape and other textures differ only in their images. In
// one room, only neighbouring views have anything in common.
TEST(RelocaliserTest, DoesNotTakeAnotherSceneForThePlace) {
  FurnishedRoom room(1);
  Search relocaliser(room.camera());
  for (int i = 0; i < 8; ++i) {
    relocaliser.Add(room.See(Moved(0.05 * i, 0.0, 0.0)), i);
  }
  for (const uint32_t seed : {2u, 3u, 4u, 5u}) {
    FurnishedRoom other(seed);
    for (const double degrees : {0.0, 10.0, 120.0}) {
      const Frame frame = other.See(TurnedBy(degrees));
      for (int i = 0; i < 2; ++i) {
        EXPECT_FALSE(relocaliser.Find(frame)) << seed << " " << degrees;
      }
    }
  }
  for (const double degrees : {100.0, 140.0, 180.0, 220.0, 260.0}) {
    EXPECT_FALSE(relocaliser.Find(room.See(TurnedBy(degrees)))) << degrees;
  }
}

TEST(RelocaliserTest, TheSameCallsGiveTheSameMotion) {
  FurnishedRoom room(1);
  const Frame keyframe = room.See(Rigid3d());
  const Frame frame = room.See(TurnedBy(15.0));
  std::optional<Relocalisation> found[2];
  for (std::optional<Relocalisation>& result : found) {
    Search relocaliser(room.camera());
    relocaliser.Add(keyframe, 1);
    result = relocaliser.Find(frame);
    ASSERT_TRUE(result.has_value());
  }
  EXPECT_EQ(found[0]->inliers, found[1]->inliers);
  EXPECT_EQ(found[0]->cur_from_keyframe.translation,
            found[1]->cur_from_keyframe.translation);
}

}  // namespace
}  // namespace rgbd_pose
