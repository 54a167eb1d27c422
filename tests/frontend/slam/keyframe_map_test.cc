#include "frontend/slam/keyframe_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/map_parts.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

TEST(KeyframeMapTest, TakesASoundMap) {
  EXPECT_EQ(NoiseMap(5, 0).Check(), "");
  EXPECT_EQ(NoiseMap(0, 0).Check(), "") << "of a camera that was always lost";
}

TEST(KeyframeMapTest, SaysWhatIsWrong) {
  const struct {
    std::function<void(KeyframeMap*)> spoil;
    const char* message;
  } kCases[] = {
      {[](KeyframeMap* map) { map->camera.fx = NAN; }, "camera: "},
      {[](KeyframeMap* map) { map->camera.height += 1; }, "keyframe -3: the "},
      {[](KeyframeMap* map) { map->keyframes[2].id = 4; },
       "keyframe 4: appears twice"},
      {[](KeyframeMap* map) {
         map->keyframes[1].world_from_cam.translation.x() = NAN;
       },
       "keyframe 4: the pose must be finite"},
      {[](KeyframeMap* map) {
         map->keyframes[1].world_from_cam.rotation.coeffs() *= 1.1;
       },
       "keyframe 4: the pose"},
      {[](KeyframeMap* map) { map->keyframes[1].images = {}; },
       "keyframe 4: the images"},
      {[](KeyframeMap* map) { map->edges[0].cur = 5; },
       "edge from keyframe -3 to 5: there is no keyframe 5"},
      {[](KeyframeMap* map) { map->edges[0].ref = map->edges[0].cur; },
       "edge from keyframe 4 to 4: it must connect two different keyframes"},
      {[](KeyframeMap* map) { map->keyframes[0].segment = 7; },
       "edge from keyframe -3 to 4: its keyframes are of two segments"},
      {[](KeyframeMap* map) {
         map->edges[1].cur_from_ref.rotation.w() = INFINITY;
       },
       "edge from keyframe 4 to 11: the motion"},
      {[](KeyframeMap* map) { map->ups[0].keyframe = 5; },
       "up of keyframe 5: there is no such keyframe"},
      {[](KeyframeMap* map) { map->ups[1].keyframe = 4; },
       "up of keyframe 4: appears twice"},
      {[](KeyframeMap* map) { map->ups[1].in_cam.x() = NAN; },
       "up of keyframe 18: it must be finite"},
      {[](KeyframeMap* map) { map->ups[1].in_cam *= 1.1; },
       "up of keyframe 18: it must be finite and of unit length"},
      {[](KeyframeMap* map) { map->ups[0].sigma = 0.0; },
       "up of keyframe 4: sigma must be positive"},
  };
  for (const auto& c : kCases) {
    KeyframeMap map = NoiseMap(4, 0);
    c.spoil(&map);
    EXPECT_THAT(map.Check(), HasSubstr(c.message));
  }
}

TEST(KeyframeMapTest, CovariancesMustBePositiveDefinite) {
  const auto with = [](const MotionMatrix& covariance) {
    KeyframeMap map = NoiseMap(2, 0);
    map.edges[0].covariance = covariance;
    return map.Check();
  };
  const MotionMatrix one = MotionMatrix::Identity();
  EXPECT_EQ(with(one), "");
  EXPECT_EQ(with(1e-20 * one), "");
  MotionMatrix skew = one;
  skew(0, 1) = 0.5;
  MotionMatrix large = one * 1e308;
  large(0, 1) = large(1, 0) = 1e308;
  for (const MotionMatrix& wrong :
       {MotionMatrix(MotionMatrix::Zero()), MotionMatrix(-one),
        MotionMatrix(MotionMatrix::Ones()), skew, large,
        MotionMatrix(one * NAN), MotionMatrix(one * INFINITY)}) {
    EXPECT_EQ(with(wrong),
              "edge from keyframe -3 to 4: the covariance must be symmetric "
              "and positive definite")
        << wrong;
  }
}

TEST(KeyframeMapTest, TellsCamerasApart) {
  const KeyframeMap map = NoiseMap(0, 0);
  Camera other = map.camera;
  EXPECT_EQ(map.CheckCamera(other), "");
  other.k2 = 0.5;
  EXPECT_EQ(map.CheckCamera(other),
            "k2 is -0.3333333333333333 in the map, 0.5 in the camera");
  other.width = 640;
  EXPECT_EQ(map.CheckCamera(other),
            "the map's images have 32 x 24 pixels, the camera's 640 x 24");
}

}  // namespace
}  // namespace rgbd_pose
