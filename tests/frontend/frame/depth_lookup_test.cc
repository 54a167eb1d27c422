#include "frontend/frame/depth_lookup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_pose {
namespace {

constexpr double kScale = 5000.0;
constexpr double kRawStep = 1.0 / kScale;  // m, of the 16-bit image

Frame FlatFrame(double depth) {
  Frame frame;
  frame.depth =
      cv::Mat(480, 640, CV_16UC1, cv::Scalar(std::lround(depth * kScale)));
  frame.depth_scale = kScale;
  return frame;
}

void Set(Frame* frame, int column, int row, double depth) {
  frame->depth.at<uint16_t>(row, column) =
      static_cast<uint16_t>(std::lround(depth * kScale));
}

TEST(DepthLookupTest, ReadsAFlatWall) {
  const DepthSample sample = LookUpDepth(FlatFrame(2.0), 100.3, 200.7, {});
  EXPECT_NEAR(sample.depth, 2.0, kRawStep);
  EXPECT_DOUBLE_EQ(sample.sigma, 1.425e-3 * 4.0);
}

// A wall that is seen at an angle: its inverse depth is linear in the image.
double SlantedDepth(double column) {
  return 1.0 / (0.5 + 1e-3 * (column - 300));
}

Frame SlantedFrame() {
  Frame frame = FlatFrame(2.0);
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      Set(&frame, column, row, SlantedDepth(column));
    }
  }
  return frame;
}

// Exact between pixels.
TEST(DepthLookupTest, ReadsASlantedWallBetweenPixels) {
  const DepthSample sample = LookUpDepth(SlantedFrame(), 320.4, 240.0, {});
  EXPECT_NEAR(sample.depth, SlantedDepth(320.4), kRawStep);
}

TEST(DepthLookupTest, NeverMixesTwoSurfaces) {
  Frame frame = FlatFrame(2.0);
  frame.depth.colRange(320, 640).setTo(std::lround(2.5 * kScale));
  EXPECT_EQ(LookUpDepth(frame, 319.0, 240.0, {}).depth, 0.0);
  EXPECT_EQ(LookUpDepth(frame, 320.0, 240.0, {}).depth, 0.0);
  EXPECT_NEAR(LookUpDepth(frame, 318.0, 240.0, {}).depth, 2.0, kRawStep);
  EXPECT_NEAR(LookUpDepth(frame, 321.0, 240.0, {}).depth, 2.5, kRawStep);
}

TEST(DepthLookupTest, FitsThePlaneBesideOneOrTwoHoles) {
  Frame frame = SlantedFrame();
  const double complete = LookUpDepth(frame, 320.4, 240.0, {}).sigma;
  Set(&frame, 321, 239, 0.0);
  frame.depth.at<uint16_t>(240, 321) = Frame::kNoDepth;
  const DepthSample sample = LookUpDepth(frame, 320.4, 240.0, {});
  EXPECT_NEAR(sample.depth, SlantedDepth(320.4), 2.0 * kRawStep);
  // The variance of the middle of these seven is 19 / 105, of all nine 1 / 9.
  EXPECT_NEAR(sample.sigma, std::sqrt(9.0 * 19.0 / 105.0) * complete, 1e-5);
}

TEST(DepthLookupTest, TakesTheCentreIfAWholeSideIsMissing) {
  Frame frame = SlantedFrame();
  for (int row = 239; row <= 241; ++row) Set(&frame, 321, row, 0.0);
  EXPECT_NEAR(LookUpDepth(frame, 320.4, 240.0, {}).depth, SlantedDepth(320),
              kRawStep);
  Set(&frame, 319, 240, 0.0);
  EXPECT_EQ(LookUpDepth(frame, 320.4, 240.0, {}).depth, 0.0);
}

TEST(DepthLookupTest, HasNoneOnAHoleOutsideOrBeyondTheLimits) {
  Frame frame = FlatFrame(2.0);
  Set(&frame, 100, 100, 0.0);
  EXPECT_EQ(LookUpDepth(frame, 100.0, 100.0, {}).depth, 0.0);
  for (const double u : {-5.0, 0.0, 639.0, 700.0}) {
    EXPECT_EQ(LookUpDepth(frame, u, 240.0, {}).depth, 0.0) << u;
  }
  EXPECT_EQ(LookUpDepth(FlatFrame(9.0), 320, 240, {}).depth, 0.0);
  EXPECT_EQ(LookUpDepth(FlatFrame(0.2), 320, 240, {}).depth, 0.0);
}

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
  frame.depth.rowRange(95, 96).setTo(0);
  frame.depth.at<uint16_t>(100, 105) = 0;
  EXPECT_EQ(NormalAt(frame, camera, 100.0, 100.0), Vector3d::Zero());
  EXPECT_NE(NormalAt(frame, camera, 200.0, 200.0), Vector3d::Zero());
}

TEST(SurfaceNormalTest, IsThatOfTheRestBesideOneOrTwoHoles) {
  const Camera camera;
  const Vector3d normal = Vector3d(0.5, 0.2, -1).normalized();
  Frame frame = PlaneFrame(camera, normal, 1.5);
  for (const int row : {235, 240}) frame.depth.at<uint16_t>(row, 305) = 0;
  EXPECT_LE((NormalAt(frame, camera, 310.0, 240.0) - normal).norm(), 0.02);
  frame.depth.at<uint16_t>(235, 315) += 400;
  EXPECT_EQ(NormalAt(frame, camera, 310.0, 240.0), Vector3d::Zero())
      << "one of the others is on another surface";
  frame.depth.at<uint16_t>(235, 315) -= 400;
  frame.depth.at<uint16_t>(245, 305) = 0;
  EXPECT_EQ(NormalAt(frame, camera, 310.0, 240.0), Vector3d::Zero())
      << "a whole side is missing";
}

using testing::HasSubstr;
using testing::IsEmpty;

// A third of the pixels have no depth; the others are around the median.
Frame FrameWithMedian(uint16_t raw, double depth_scale) {
  Frame frame;
  frame.index = 12;
  frame.depth_scale = depth_scale;
  frame.depth = cv::Mat(6, 5, CV_16UC1, cv::Scalar(raw));
  frame.depth.row(0).setTo(0);
  frame.depth.row(1).setTo(Frame::kNoDepth);
  frame.depth.row(2).setTo(raw - 1);
  frame.depth.row(3).setTo(raw + 1);
  return frame;
}

TEST(DepthScaleTest, PlausibleDepthGivesNoWarning) {
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(10000, 5000)), IsEmpty());
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(1600, 5000)), IsEmpty());
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(20000, 1000)), IsEmpty());
}

TEST(DepthScaleTest, WarnsBelowAndAboveWhatIsPlausible) {
  const std::string near = DepthScaleWarning(FrameWithMedian(500, 5000));
  EXPECT_THAT(near, HasSubstr("frame 12"));
  EXPECT_THAT(near, HasSubstr("0.1 m"));
  EXPECT_THAT(near, HasSubstr("check the depth scale"));
  // Millimetres of a scene 1.4 m away, all of them too near to be used.
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(1400, 5000)),
              HasSubstr("0.28 m"));
  const std::string far = DepthScaleWarning(FrameWithMedian(25000, 1000));
  EXPECT_THAT(far, HasSubstr("25 m"));
  EXPECT_THAT(far, HasSubstr("1000 raw units"));
}

TEST(DepthScaleTest, AFrameWithoutDepthGivesNoWarning) {
  Frame frame = FrameWithMedian(10000, 5000);
  frame.depth.setTo(Frame::kNoDepth);
  EXPECT_THAT(DepthScaleWarning(frame), IsEmpty());
}

}  // namespace
}  // namespace rgbd_pose
