#include "frontend/fusion/mesh_fusion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "frontend/fusion/mesh_file.h"
#include "frontend/fusion/surface_mesh.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {
namespace {

SyntheticOptions MeshRoom() {
  SyntheticOptions options;
  options.path = "circle";
  options.frames = 6;
  options.rate_hz = 3.0;
  options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
  return options;
}

TriangleMesh Fuse(const SyntheticDataset& dataset, int threads = 1) {
  MeshFusionOptions options;
  options.camera = dataset.camera().camera;
  options.threads = threads;
  EXPECT_EQ(options.Check(), "");
  MeshFusion fusion(options);
  for (int i = 0; i < dataset.size(); ++i) {
    fusion.Add(dataset.Read(i), dataset.WorldFromCam(i));
  }
  return fusion.Mesh();
}

double DistanceTo(const Scene& scene, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::max();
  for (const SceneFace& face : scene.faces) {
    const Eigen::Vector3d from = point - face.origin;
    const double u = std::clamp(from.dot(face.u_axis), 0.0, face.width);
    const double v = std::clamp(from.dot(face.v_axis), 0.0, face.height);
    nearest =
        std::min(nearest, (from - u * face.u_axis - v * face.v_axis).norm());
  }
  return nearest;
}

// The mean distance (m) of the vertices from the surfaces of the simulation.
double MeanDistance(const TriangleMesh& mesh, const SyntheticOptions& options) {
  const Scene scene = MakeScene(options.scene, options.seed);
  double sum = 0.0;
  for (const ColoredPoint& vertex : mesh.vertices) {
    sum += DistanceTo(scene, vertex.position.cast<double>());
  }
  return sum / static_cast<double>(mesh.vertices.size());
}

TEST(MeshFusionTest, ANoisyRoomIsWhereItIsFromAllSides) {
  const SyntheticOptions options = MeshRoom();
  const SyntheticDataset dataset(options);
  const TriangleMesh mesh = Fuse(dataset);
  ASSERT_GT(mesh.triangles.size(), 100000);

  // The accuracy required for 1 cm voxels. Here only six views are used, with
  // depth twice as noisy as in images of twice the size.
  EXPECT_LT(MeanDistance(mesh, options), 0.005);

  // Triangles face the cameras, which have moved little. Noise may flip
  // triangles at the border or on slanted surfaces.
  const Eigen::Vector3f eye = dataset.WorldFromCam(0).translation.cast<float>();
  size_t seen = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto at = [&](int i) { return mesh.vertices[t[i]].position; };
    seen += (at(1) - at(0)).cross(at(2) - at(0)).dot(eye - at(0)) > 0.0F;
  }
  EXPECT_GT(seen, mesh.triangles.size() * 9 / 10);

  // Vertices have the colours of the image.
  const Frame frame = dataset.Read(0);
  const Rigid3d cam_from_world = dataset.WorldFromCam(0).Inverse();
  std::vector<int> differences;
  for (const ColoredPoint& vertex : mesh.vertices) {
    const Eigen::Vector3d point =
        cam_from_world * vertex.position.cast<double>();
    if (point.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = options.camera.camera.Project(point);
    if (!options.camera.camera.Contains(pixel, 1.0)) continue;
    const cv::Vec3b& bgr =
        frame.color.at<cv::Vec3b>(static_cast<int>(std::lround(pixel.y())),
                                  static_cast<int>(std::lround(pixel.x())));
    differences.push_back(std::abs(bgr[2] - vertex.color[0]) +
                          std::abs(bgr[0] - vertex.color[2]));
  }
  ASSERT_GT(differences.size(), mesh.vertices.size() / 2);
  std::sort(differences.begin(), differences.end());
  EXPECT_LT(differences[differences.size() / 2], 20);
}

// Between the rays of a coarse image there are blocks, too.
TEST(MeshFusionTest, ASmallImageLeavesNoHoles) {
  MeshFusionOptions options;
  options.camera = {160, 120, 131.25, 131.25, 79.5, 59.5};
  options.depth.noise.constant = 0.001;  // one frame is enough
  options.depth.noise.quadratic = 0.0;
  MeshFusion fusion(options);
  constexpr double kDepth = 3.9;
  Frame wall;
  wall.depth_scale = 1000.0;
  wall.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(1000.0 * kDepth));
  wall.gray = cv::Mat(120, 160, CV_8UC1, cv::Scalar(100));
  wall.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(100, 100, 100));
  fusion.Add(wall, Rigid3d());
  const TriangleMesh mesh = fusion.Mesh();
  double area = 0.0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto at = [&](int i) { return mesh.vertices[t[i]].position; };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  const double seen = 160.0 * 120.0 * std::pow(kDepth / options.camera.fx, 2.0);
  EXPECT_NEAR(area, seen, 0.05 * seen);
}

TEST(MeshFusionTest, ThreadsDoNotMatter) {
  SyntheticOptions options = MeshRoom();
  options.frames = 2;
  const SyntheticDataset dataset(options);
  EXPECT_TRUE(FormatMeshPly(Fuse(dataset, 1)) ==
              FormatMeshPly(Fuse(dataset, 2)));
}

TEST(MeshFusionTest, ThinIsTheSameSurface) {
  SyntheticOptions options = MeshRoom();
  options.frames = 2;
  const TriangleMesh mesh = Fuse(SyntheticDataset(options));
  constexpr size_t kMost = 5000;
  const TriangleMesh thin = SimplifyMesh(mesh, 0.01F, kMost);
  EXPECT_LE(thin.triangles.size(), kMost);
  EXPECT_GT(thin.triangles.size(), kMost / 2);
  EXPECT_LT(MeanDistance(thin, options), 0.01);
}

// A wall seen through a distorting lens is flat.
TEST(MeshFusionTest, DistortionIsTakenOut) {
  SyntheticOptions options = MeshRoom();
  options.frames = 2;
  options.noise = false;
  options.camera = *CameraPreset("tum_fr1");
  const SyntheticDataset dataset(options);
  const TriangleMesh mesh = Fuse(dataset);
  ASSERT_GT(mesh.vertices.size(), 10000);
  EXPECT_LT(MeanDistance(mesh, options), 0.002);
}

TEST(MeshFusionTest, RefusesWhatMakesNoSense) {
  MeshFusionOptions options;
  options.voxel_size = 0.0;
  EXPECT_EQ(options.Check(), "the voxel size must be 0.001 to 1 m");
  options = {};
  options.depth.max_depth = options.max_depth = 1e9;
  EXPECT_NE(options.Check(), "");
  options = {};
  options.threads = 0;
  EXPECT_NE(options.Check(), "");
}

}  // namespace
}  // namespace rgbd_pose
