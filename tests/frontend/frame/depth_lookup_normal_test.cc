#include <gtest/gtest.h>

#include <cmath>

#include "frontend/frame/depth_lookup.h"

namespace rgbd_pose {
namespace {

// For a camera without distortion.
Eigen::Vector3d NormalAt(const Frame& frame, const Camera& camera, double u,
                         double v) {
  return LookUpNormal(frame, camera, u, v, camera.Ray(u, v).head<2>());
}

using Eigen::Vector3d;

// The depth image of the plane normal . X = -distance (normal towards camera).
Frame PlaneFrame(const Camera& camera, const Vector3d& normal,
                 double distance) {
  Frame frame;
  frame.depth = cv::Mat(camera.height, camera.width, CV_16UC1, cv::Scalar(0));
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Vector3d ray((column - camera.cx) / camera.fx,
                         (row - camera.cy) / camera.fy, 1.0);
      const double depth = -distance / normal.dot(ray);
      if (depth <= 0.0 || depth > 10.0) continue;
      frame.depth.at<uint16_t>(row, column) =
          static_cast<uint16_t>(std::lround(depth * frame.depth_scale));
    }
  }
  return frame;
}

TEST(SurfaceNormalTest, FindsSlantedPlanes) {
  const Camera camera;
  for (const Vector3d& direction :
       {Vector3d(0, 0, -1), Vector3d(0.5, 0, -1), Vector3d(0, -0.7, -1),
        Vector3d(-0.4, 0.6, -1)}) {
    const Vector3d normal = direction.normalized();
    const Frame frame = PlaneFrame(camera, normal, 1.5);
    for (const double u : {200.0, 320.0, 430.0}) {
      const Vector3d found = NormalAt(frame, camera, u, 240.0);
      // 0.2 mm depth steps over 10 px of about 3 mm.
      EXPECT_LE((found - normal).norm(), 0.02) << direction.transpose();
    }
  }
}

TEST(SurfaceNormalTest, HasNoneAtEdgesHolesAndBorders) {
  const Camera camera;
  Frame frame = PlaneFrame(camera, Vector3d(0, 0, -1), 2.0);
  EXPECT_EQ(NormalAt(frame, camera, 2.0, 240.0), Vector3d::Zero());
  frame.depth.colRange(322, 640).setTo(12500);
  EXPECT_EQ(NormalAt(frame, camera, 320.0, 240.0), Vector3d::Zero());
  frame.depth.at<uint16_t>(100, 105) = 0;
  EXPECT_EQ(NormalAt(frame, camera, 100.0, 100.0), Vector3d::Zero());
  EXPECT_NE(NormalAt(frame, camera, 200.0, 200.0), Vector3d::Zero());
}

}  // namespace
}  // namespace rgbd_pose
