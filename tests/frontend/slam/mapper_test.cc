#include "frontend/slam/mapper.h"

#include <gtest/gtest.h>

#include <vector>

#include "frontend/settings/settings.h"
#include "tests/support/map_parts.h"

namespace rgbd_pose {
namespace {

Keyframe Noise(int id) {
  Keyframe keyframe;
  keyframe.id = id;
  keyframe.segment = id;
  keyframe.frame = PreparedFrame(NoiseFrame(id));
  keyframe.world_from_cam.translation.x() = id;
  return keyframe;
}

// With the thousands of keyframes of an hour, updates contain only moved ones.
TEST(MapperTest, TellsOfEachKeyframeOnce) {
  const Camera camera = {kMapWidth, kMapHeight, 50.0, 50.0, 20.0, 15.0};
  Mapper mapper(MappingOptions(), MakeTracker(OdometrySettings(), {camera}));
  for (const int id : {3, 7}) {
    const MapUpdate update = mapper.Add(Noise(id), {});
    ASSERT_EQ(update.moved.size(), 1u);
    EXPECT_EQ(update.moved.begin()->first, id);
    EXPECT_EQ(update.moved.at(id).map_from_cam.translation.x(), id);
    EXPECT_EQ(update.moved.at(id).segment, id);
  }
  EXPECT_TRUE(mapper.Finish().moved.empty());
}

// Tracked against two segments: a loaded map and the segment before.
TEST(MapperTest, TrackedEdgesJoinSegments) {
  const Camera camera = {kMapWidth, kMapHeight, 50.0, 50.0, 20.0, 15.0};
  Mapper mapper(MappingOptions(), MakeTracker(OdometrySettings(), {camera}));
  mapper.Add(Noise(3), {});
  mapper.Add(Noise(7), {});
  std::vector<RelativePose> edges;
  RelativePose edge;
  edge.cur = 9;
  edge.covariance = 1e-6 * MotionMatrix::Identity();
  for (const int ref : {3, 7}) {
    edge.ref = ref;
    edge.cur_from_ref.translation.z() = ref;
    edges.push_back(edge);
  }
  EXPECT_EQ(mapper.Add(Noise(9), edges).joined, 1);
  const KeyframeMap map = mapper.Map();
  for (const MapEdge& measured : map.edges) EXPECT_TRUE(measured.is_tracked);
  for (const Keyframe& keyframe : map.keyframes) {
    EXPECT_EQ(keyframe.segment, 7);
    EXPECT_NEAR(keyframe.world_from_cam.translation.x(), 7.0, 1e-9);
  }
  EXPECT_NEAR(map.keyframes[2].world_from_cam.translation.z(), -7.0, 1e-9);
  EXPECT_NEAR(map.keyframes[0].world_from_cam.translation.z(), -4.0, 1e-9);
}

// Its timing displaces a keyframe along its own x axis, which is the z axis of
// the world after a quarter of a turn about y.
TEST(MapperTest, CovariancesHaveTheTimingOfAKeyframeInTheWorld) {
  constexpr double kVariance = 1e-4;  // rad^2 and m^2
  const Camera camera = {kMapWidth, kMapHeight, 50.0, 50.0, 20.0, 15.0};
  const Rigid3d turned =
      Rigid3d::FromRotationVector({0.0, M_PI / 2.0, 0.0}, {1.0, 0.0, 0.0});
  std::vector<MotionMatrix> covariances;
  for (const double variance : {0.0, kVariance}) {
    Mapper mapper(MappingOptions(), MakeTracker(OdometrySettings(), {camera}));
    mapper.Add(Noise(3), {});
    RelativePose edge;
    edge.ref = 3;
    edge.cur_from_ref = turned.Inverse();
    edge.covariance = 1e-6 * MotionMatrix::Identity();
    Keyframe keyframe = Noise(7);
    keyframe.timing_covariance(0, 0) = keyframe.timing_covariance(3, 3) =
        variance;
    mapper.Add(keyframe, {edge});
    mapper.Finish();
    covariances.push_back(mapper.Covariances().at(1));
  }
  MotionMatrix expected = MotionMatrix::Zero();
  expected(0, 0) = expected(5, 5) = kVariance;
  EXPECT_TRUE((covariances[1] - covariances[0]).isApprox(expected, 1e-6))
      << covariances[1] - covariances[0];
}

TEST(MapperTest, AMapKeepsWhichWayIsUp) {
  KeyframeMap map = NoiseMap(5, 0);
  ASSERT_EQ(map.ups.size(), 2u);
  Mapper mapper(MappingOptions(),
                MakeTracker(OdometrySettings(), {map.camera}));
  mapper.Load(map, /*is_held=*/false);
  mapper.SetUp({map.keyframes[4].id, Eigen::Vector3d::UnitZ(), 0.02});
  map.ups.push_back({map.keyframes[4].id, Eigen::Vector3d::UnitZ(), 0.02});
  EXPECT_TRUE(IsSameMap(mapper.Map(), map));
}

}  // namespace
}  // namespace rgbd_pose
