// What Slam makes of maps before the first frame.

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "frontend/slam/slam.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/map_parts.h"

namespace rgbd_pose {
namespace {

// Ids and segments of a map are any integers; those of two maps may meet.
TEST(LoadedMapsTest, MapsStayApartWhateverTheNumbersOfTheirKeyframes) {
  const auto numbered = [](int first, int step) {
    KeyframeMap map = NoiseMap(3, 0);
    map.edges.clear();
    map.ups.clear();
    for (int i = 0; i < 3; ++i) {
      map.keyframes[i].id = first + step * i;
      map.keyframes[i].segment = first;
    }
    return map;
  };
  RgbdCamera camera;
  camera.camera = numbered(0, 1).camera;
  Slam slam(OdometrySettings(), SlamSettings(), camera);
  slam.Load(numbered(0, 1), false);
  slam.Load(numbered(-2, 1), false);
  ExpectInputError(
      [&] {
        slam.Load(numbered(0, std::numeric_limits<int>::max() / 2), false);
      },
      {"map: the ids", "number them from 0"});
  EXPECT_EQ(slam.keyframe_poses().size(), 6u);
  slam.Finish();
  const KeyframeMap both = slam.Map();
  EXPECT_EQ(both.Check(), "");
  std::set<int> segments;
  for (const Keyframe& keyframe : both.keyframes) {
    segments.insert(keyframe.segment);
  }
  EXPECT_EQ(segments.size(), 2u);
}

}  // namespace
}  // namespace rgbd_pose
