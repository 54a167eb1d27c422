#include <gtest/gtest.h>

#include "apps/export/export_format.h"
#include "frontend/slam/map_folder.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/map_parts.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// Five keyframes, the first three of which are connected.
class FinishedMapTest : public testing::Test {
 protected:
  FinishedRun Saved(const KeyframeMap& map) {
    SaveMap(folder_ / "map", map);
    return MapAsRun(folder_ / "map");
  }

  KeyframeMap map_ = NoiseMap(5, 0);
  const TempFolder folder_;
};

TEST_F(FinishedMapTest, HasTheLargestPartInTheOrderOfIds) {
  std::swap(map_.keyframes[0], map_.keyframes[2]);
  const FinishedRun run = Saved(map_);
  std::swap(map_.keyframes[0], map_.keyframes[2]);
  EXPECT_EQ(run.frames, (std::vector<int>{-3, 4, 11}));
  for (int i = 0; i < 3; ++i) {
    const Keyframe& expected = map_.keyframes[i];
    EXPECT_EQ(run.trajectory[i].timestamp, expected.images.timestamp);
    EXPECT_TRUE(IsSameMotion(run.trajectory[i].world_from_cam,
                             expected.world_from_cam));
  }
  map_.keyframes[2].segment = 1;
  map_.edges.erase(map_.edges.begin() + 1);  // from the second to it
  EXPECT_EQ(Saved(map_).frames, (std::vector<int>{11, 18, 25}));
}

TEST_F(FinishedMapTest, ImagesAreThoseOfTheKeyframes) {
  const FinishedRun run = Saved(map_);
  ExportOptions all;
  all.step.min_angle_deg = 0.0;
  const auto source = OpenRecording(run);
  EXPECT_EQ(source->camera().camera.fx, map_.camera.fx);
  const auto expect = [&](const Frame& frame, int view) {
    const Frame saved = map_.keyframes[view].images.Restore();
    EXPECT_EQ(cv::norm(frame.depth, saved.depth, cv::NORM_INF), 0.0);
    EXPECT_EQ(frame.depth_scale, saved.depth_scale);
    for (int channel = 0; channel < 3; ++channel) {
      cv::Mat levels;
      cv::extractChannel(frame.color, levels, channel);
      EXPECT_EQ(cv::norm(levels, saved.gray, cv::NORM_INF), 0.0);
    }
  };
  EXPECT_EQ(ReadViews(run, all, source.get(), expect),
            (std::vector<int>{0, 1, 2}));
}

TEST_F(FinishedMapTest, CountsSecondsWhereTwoKeyframesHaveOneTime) {
  map_.keyframes[2].images.timestamp = map_.keyframes[0].images.timestamp;
  const FinishedRun run = Saved(map_);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(run.trajectory[i].timestamp, i);
}

TEST_F(FinishedMapTest, IsLevelByWhatItsKeyframesHaveMeasured) {
  const Eigen::Vector3d up =
      map_.keyframes[1].world_from_cam.rotation * map_.ups[0].in_cam;
  EXPECT_TRUE((Saved(map_).level_from_world * up)
                  .isApprox(-Eigen::Vector3d::UnitY(), 1e-12));
  map_.ups.clear();
  EXPECT_TRUE(Saved(map_).level_from_world.IsIdentity());
}

TEST_F(FinishedMapTest, TheGraphHasAllKeyframesAndMotions) {
  const std::string file = folder_ / "map.g2o";
  ExportOptions options;
  options.output = file;
  EXPECT_EQ(ExportG2o(Saved(map_), options),
            "5 vertices, 3 edges in " + file + "\n");
}

TEST_F(FinishedMapTest, SaysThatThereIsNoMapOrNothingInIt) {
  map_.keyframes.clear();
  map_.edges.clear();
  map_.ups.clear();
  ExpectInputError([&] { Saved(map_); }, {"map: the map has no keyframes"});
  ExpectInputError([&] { MapAsRun(folder_ / "none"); },
                   {"none: no such folder"});
}

}  // namespace
}  // namespace rgbd_pose
