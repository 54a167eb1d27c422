#include "frontend/simulation/synthetic_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "frontend/simulation/synthetic_path.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

// Single precision (1e-7 per operation) over the few operations for a depth.
constexpr double kRelativeTolerance = 5e-6;

// A smaller image with the same field of view, for speed.
Camera RenderCamera() {
  return {160, 120, 131.25, 131.25, 79.5, 59.5, 0, 0, 0};
}

// The same depths by the textbook method, in double precision: the nearest of
// all rectangles hit from the front, each enlarged by `wider` (m) on every
// side.
double NearestDepth(const Scene& scene, const Rigid3d& world_from_cam,
                    const Vector3d& ray_in_cam, double wider) {
  const Vector3d ray = world_from_cam.rotation * ray_in_cam;
  double nearest = std::numeric_limits<double>::infinity();
  for (const SceneFace& face : scene.faces) {
    const double approach = face.normal.dot(ray);
    if (approach >= 0.0) continue;
    const double z =
        face.normal.dot(face.origin - world_from_cam.translation) / approach;
    const Vector3d on_face = world_from_cam.translation + z * ray - face.origin;
    const double u = face.u_axis.dot(on_face);
    const double v = face.v_axis.dot(on_face);
    if (z > 0.0 && u >= -wider && v >= -wider && u <= face.width + wider &&
        v <= face.height + wider) {
      nearest = std::min(nearest, z);
    }
  }
  return nearest;
}

TEST(SyntheticRendererTest, DepthIsThatOfTheNearestFace) {
  const Scene scene = MakeScene("room", 1);
  const Camera distorted = CameraPreset("tum_fr1")->camera;
  // Faces overlap by 0.1 mm in the renderer. Rays that pass an edge at a
  // smaller distance than this (m) are left out.
  constexpr double kEdge = 3e-4;
  for (const Camera& camera : {RenderCamera(), distorted}) {
    const Renderer renderer(scene, camera);
    for (const char* path : {"xyz", "pan_tilt", "circle"}) {
      const Rigid3d pose = FindSyntheticPath(path)(1.1, 5.0);
      const Rendering image = renderer.Render(pose);
      int rays = 0;
      int at_edges = 0;
      for (int v = 0; v < camera.height; v += 7) {
        for (int u = 0; u < camera.width; u += 7) {
          const Vector3d ray = camera.Unproject({u, v}, 1.0);
          const double exact = NearestDepth(scene, pose, ray, kEdge);
          ++rays;
          if (exact != NearestDepth(scene, pose, ray, -kEdge)) {
            ++at_edges;
            continue;
          }
          EXPECT_NEAR(image.depth.at<float>(v, u), exact,
                      kRelativeTolerance * exact)
              << path << " at " << u << ", " << v;
        }
      }
      EXPECT_LT(at_edges, 0.05 * rays) << path;
    }
  }
}

TEST(SyntheticRendererTest, LeavesNoCracksBetweenFaces) {
  const Renderer renderer(MakeScene("room", 1), Camera{});
  for (const double t : {0.0, 0.7, 1.9, 3.3}) {
    const Rendering image =
        renderer.Render(FindSyntheticPath("pan_tilt")(t, 5.0));
    EXPECT_EQ(cv::countNonZero(image.depth), 640 * 480);
  }
}

TEST(SyntheticRendererTest, SeesAWallFromAnyTurnWhereItIs) {
  Scene scene;
  AddBox({{0, 0, -2}, {6, 6, 4}, 20}, true, {}, &scene);
  const Camera camera = RenderCamera();
  const Rigid3d pose(Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2), {0.4, -0.3, 0.2});
  const Rendering image = Renderer(scene, camera).Render(pose);
  for (int v = 0; v < camera.height; v += 5) {
    for (int u = 0; u < camera.width; u += 5) {
      const double depth = image.depth.at<float>(v, u);
      const Vector3d point = pose * camera.Unproject({u, v}, depth);
      double off_nearest_plane = 1.0;
      for (const SceneFace& face : scene.faces) {
        off_nearest_plane = std::min(
            off_nearest_plane, std::abs(face.normal.dot(point - face.origin)));
      }
      EXPECT_LT(off_nearest_plane, kRelativeTolerance * 6.0);
    }
  }
}

TEST(SyntheticRendererTest, SeesNothingOfABoxFromWithinOrBehind) {
  Scene scene;
  AddBox({{0, 0, -1}, {2, 2, 2}, 0}, false, {}, &scene);
  const Renderer renderer(scene, RenderCamera());
  EXPECT_EQ(cv::countNonZero(renderer.Render(Rigid3d()).depth), 0);
  const Rigid3d above = Moved(0, 0, 3), below = Moved(0, 0, -3);
  EXPECT_EQ(cv::countNonZero(renderer.Render(above).depth), 0);
  EXPECT_GT(cv::countNonZero(renderer.Render(below).depth), 0);
}

TEST(SyntheticRendererTest, DoesNotDependOnTheNumberOfThreads) {
  const Renderer renderer(MakeScene("room", 1), RenderCamera());
  const Rigid3d pose = FindSyntheticPath("xyz")(2.0, 5.0);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const Rendering one = renderer.Render(pose);
  cv::setNumThreads(2);
  const Rendering two = renderer.Render(pose);
  cv::setNumThreads(threads);
  EXPECT_EQ(cv::norm(one.color, two.color, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(one.depth, two.depth, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace rgbd_pose
