#include "frontend/simulation/synthetic_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_renderer.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

Camera SceneCamera() { return {160, 120, 131.25, 131.25, 79.5, 59.5, 0, 0, 0}; }

Rendering Look(const std::string& scene, const Rigid3d& world_from_cam) {
  return Renderer(MakeScene(scene, 1), SceneCamera()).Render(world_from_cam);
}

Rigid3d PoseOf(const std::string& path, double t) {
  return FindSyntheticPath(path)(t, 5.0);
}

cv::Mat Gray(const Rendering& image) {
  cv::Mat gray;
  cv::cvtColor(image.color, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

// The share of pixels whose neighbours differ by more than 4 gray levels.
double TexturedShare(const Rendering& image) {
  cv::Mat along, down;
  cv::Sobel(Gray(image), along, CV_32F, 1, 0, 3, 1.0 / 8.0);
  cv::Sobel(Gray(image), down, CV_32F, 0, 1, 3, 1.0 / 8.0);
  cv::Mat size;
  cv::magnitude(along, down, size);
  return cv::countNonZero(size > 4.0) / static_cast<double>(size.total());
}

TEST(SyntheticSceneTest, AllAreSeenAndTheSameEachTime) {
  for (const std::string& name : SceneNames()) {
    const std::vector<std::string> paths = SyntheticPathNames();
    const bool has_path =
        std::find(paths.begin(), paths.end(), name) != paths.end();
    const std::string path = has_path             ? name
                             : name == "corridor" ? "walk"
                                                  : "xyz";
    const Rendering one = Look(name, PoseOf(path, 1.0));
    const Rendering two = Look(name, PoseOf(path, 1.0));
    EXPECT_EQ(cv::norm(one.color, two.color, cv::NORM_INF), 0.0) << name;
    EXPECT_EQ(cv::norm(one.depth, two.depth, cv::NORM_INF), 0.0) << name;
    EXPECT_EQ(cv::countNonZero(one.depth), one.depth.rows * one.depth.cols)
        << name;
    const double brightness = cv::mean(Gray(one))[0];
    EXPECT_GT(brightness, 60.0) << name;
    EXPECT_LT(brightness, 200.0) << name;
  }
}

TEST(SyntheticSceneTest, PlainRoomHasShapesButNoTexture) {
  for (const double t : {0.0, 1.3, 2.9}) {
    const Rendering plain = Look("plain_room", PoseOf("handheld", t));
    EXPECT_GT(TexturedShare(Look("room", PoseOf("handheld", t))), 0.5) << t;
    EXPECT_LT(TexturedShare(plain), 0.15) << t;
    cv::Scalar mean, spread;
    cv::meanStdDev(plain.depth, mean, spread);
    EXPECT_GT(spread[0], 0.3) << t;  // m
  }
}

TEST(SyntheticSceneTest, CorridorLooksTheSameFromFurtherOn) {
  const Rigid3d here = PoseOf("walk", 0.0);
  Rigid3d there = here;
  there.translation.x() += 1.5;
  const Rendering a = Look("corridor", here);
  const Rendering b = Look("corridor", there);
  const cv::Mat near = a.depth < 8.0;  // range of a sensor
  EXPECT_GT(cv::countNonZero(near), 0.8 * near.total());
  EXPECT_LT(cv::norm(a.depth, b.depth, cv::NORM_INF, near), 1e-3);  // m
  EXPECT_LE(cv::norm(a.color, b.color, cv::NORM_INF, near), 1.0);
  EXPECT_LT(TexturedShare(a), 0.1);
  double farthest = 0.0;
  cv::minMaxLoc(a.depth, nullptr, &farthest);
  EXPECT_GT(farthest, 15.0);
}

TEST(SyntheticSceneTest, WalkGoesAlongTheCorridor) {
  const Vector3d way =
      PoseOf("walk", 4.0).translation - PoseOf("walk", 0.0).translation;
  EXPECT_NEAR(way.norm(), 3.0, 0.1);
  EXPECT_GT(way.x(), 2.9);
  EXPECT_LT((PoseOf("walk", 8.0).translation - PoseOf("walk", 0.0).translation)
                .norm(),
            0.1);
}

TEST(SyntheticSceneTest, PosterWallIsOneTexturedPlane) {
  for (const char* path : {"xyz", "handheld", "circle"}) {
    const Rigid3d pose = PoseOf(path, 1.7);
    const Rendering image = Look("poster_wall", pose);
    const double wall_x =
        (pose * SceneCamera().Unproject({0, 0}, image.depth.at<float>(0, 0)))
            .x();
    for (int v = 0; v < image.depth.rows; v += 7) {
      for (int u = 0; u < image.depth.cols; u += 7) {
        const Vector3d point =
            pose * SceneCamera().Unproject({u, v}, image.depth.at<float>(v, u));
        EXPECT_NEAR(point.x(), wall_x, 1e-4) << path;  // m
      }
    }
    EXPECT_GT(TexturedShare(image), 0.5) << path;
  }
}

TEST(SyntheticSceneTest, TwinCorridorsLookAlikeAndTheHallDoesNot) {
  for (const double t : {2.0, 9.0, 15.0}) {
    const Rigid3d here = PoseOf("twin_corridors", t);
    Rigid3d there = here;
    there.translation.x() += kTwinShift;
    const Rendering a = Look("twin_corridors", here);
    const Rendering b = Look("twin_corridors", there);
    EXPECT_LT(cv::norm(a.depth, b.depth, cv::NORM_INF), 1e-3) << t;  // m
    EXPECT_LT(cv::norm(a.color, b.color, cv::NORM_L1) / a.color.total(), 0.1);
    EXPECT_GT(TexturedShare(a), 0.35) << t;
    there.translation.x() = here.translation.x() + kTwinShift / 2.0;
    EXPECT_GT(
        cv::norm(a.depth, Look("twin_corridors", there).depth, cv::NORM_INF),
        0.5)
        << t;
  }
}

TEST(SyntheticSceneTest, ToursSeeTextureWithinReach) {
  for (const char* name : {"table", "two_rooms", "twin_corridors"}) {
    for (double t = 0.0; t < 340.0; t += 17.0) {
      const Rendering image = Look(name, PoseOf(name, t));
      EXPECT_GT(TexturedShare(image), 0.3) << name << " " << t;
      const cv::Mat within = (image.depth > 0.5) & (image.depth < 8.0);
      EXPECT_GT(cv::countNonZero(within), 0.75 * within.total())
          << name << " " << t;
    }
  }
}

// Paint sticks to surfaces, highlights do not: bright spots are darker when
// seen from another position.
TEST(SyntheticSceneTest, HighlightsOfTheGlossyRoomFollowTheCamera) {
  const Camera camera = SceneCamera();
  const Rigid3d here = PoseOf("xyz", 0.0);
  const Rigid3d there = here * Moved(0.6, 0.0, 0.0);
  const Rendering glossy = Look("glossy_room", here);
  const Rendering from_there = Look("glossy_room", there);
  const cv::Mat paint = Gray(Look("room", here));
  const cv::Mat paint_there = Gray(Look("room", there));
  EXPECT_EQ(cv::norm(glossy.depth, Look("room", here).depth, cv::NORM_INF),
            0.0);
  const cv::Mat light = Gray(glossy) - paint;
  const cv::Mat light_there = Gray(from_there) - paint_there;
  int bright = 0;
  int changed = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (light.at<uint8_t>(v, u) < 30) continue;
      ++bright;
      const Vector3d point =
          here * camera.Unproject({u, v}, glossy.depth.at<float>(v, u));
      const Eigen::Vector2d pixel = camera.Project(there.Inverse() * point);
      if (!camera.Contains(pixel, 1.0)) continue;
      const cv::Point at(static_cast<int>(std::lround(pixel.x())),
                         static_cast<int>(std::lround(pixel.y())));
      changed +=
          std::abs(light_there.at<uint8_t>(at) - light.at<uint8_t>(v, u)) > 10;
    }
  }
  // A patch, not the whole view.
  EXPECT_GT(bright, 0.005 * light.total());
  EXPECT_LT(bright, 0.3 * light.total());
  EXPECT_GT(changed, 0.5 * bright);
}

}  // namespace
}  // namespace rgbd_pose
