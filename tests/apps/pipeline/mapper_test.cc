#include "apps/pipeline/mapper.h"

#include <gtest/gtest.h>

#include "apps/pipeline/settings.h"
#include "tests/support/map_parts.h"

namespace rgbd_pose {
namespace {

NewKeyframe Noise(int id) {
  NewKeyframe keyframe;
  keyframe.id = id;
  keyframe.segment = id;
  keyframe.frame = NoiseFrame(id);
  keyframe.map_from_cam.translation.x() = id;
  return keyframe;
}

// An hour has thousands of keyframes: each update has those that moved alone.
TEST(MapperTest, TellsOfEachKeyframeOnce) {
  const Camera camera = {kMapWidth, kMapHeight, 50.0, 50.0, 20.0, 15.0};
  Mapper mapper(MappingOptions(), MakeTracker(OdometrySettings(), camera));
  for (const int id : {3, 7}) {
    const MapUpdate update = mapper.Add(Noise(id));
    ASSERT_EQ(update.moved.size(), 1u);
    EXPECT_EQ(update.moved.begin()->first, id);
    EXPECT_EQ(update.moved.at(id).map_from_cam.translation.x(), id);
    EXPECT_EQ(update.moved.at(id).segment, id);
  }
  EXPECT_TRUE(mapper.Finish().moved.empty());
}

}  // namespace
}  // namespace rgbd_pose
