#include "frontend/frame/depth_warper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_renderer.h"
#include "frontend/simulation/synthetic_scene.h"
#include "frontend/simulation/synthetic_sensor.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

// The size is not a multiple of the warper's blocks.
Camera MovedCamera() { return {164, 122, 131.25, 131.25, 79.5, 59.5, 0, 0, 0}; }

Frame FrameOf(const cv::Mat& depth_m) {
  Frame frame;
  frame.depth = EncodeDepth(depth_m, frame.depth_scale);
  return frame;
}

// A wall 2 m away, and a board over some columns in front of it, 1 m away.
Frame BoardAndWall(int from, int to) {
  const Camera camera = MovedCamera();
  cv::Mat depth(camera.height, camera.width, CV_32FC1, cv::Scalar(2.0));
  depth.colRange(from, to).setTo(1.0);
  return FrameOf(depth);
}

TEST(DepthWarperTest, StandingStillChangesNothing) {
  Frame frame = BoardAndWall(50, 70);
  frame.depth.at<uint16_t>(20, 30) = 0;
  DepthWarper mover(MovedCamera());
  EXPECT_EQ(cv::norm(mover.Move(frame, Rigid3d()), frame.depth, cv::NORM_INF),
            0.0);
  const uchar* memory = mover.Move(frame, Rigid3d()).data;
  frame.depth.at<uint16_t>(20, 30) = Frame::kNoDepth;
  const cv::Mat& moved = mover.Move(frame, Rigid3d());
  EXPECT_EQ(moved.at<uint16_t>(20, 30), 0);
  EXPECT_EQ(moved.data, memory);  // memory is reused
}

TEST(DepthWarperTest, GoingAheadBringsAllNearer) {
  const Frame frame = BoardAndWall(0, 0);
  DepthWarper mover(MovedCamera());
  const cv::Mat& moved = mover.Move(frame, Moved(0.0, 0.0, -0.02));
  EXPECT_EQ(cv::countNonZero(moved != 9900), 0);  // 1.98 m, 5000 a metre
}

// 0.016 m to the right moves the board by 2.1 px to the left, the wall by 1.05.
TEST(DepthWarperTest, TheNearSurfaceHidesTheFarOneAndUncoversTheUnknown) {
  const Frame frame = BoardAndWall(50, 70);
  DepthWarper mover(MovedCamera());
  const cv::Mat& moved = mover.Move(frame, Moved(-0.016, 0.0, 0.0));
  for (int v = 0; v < moved.rows; ++v) {
    for (int u = 2; u < moved.cols - 3; ++u) {
      const int raw = moved.at<uint16_t>(v, u);
      ASSERT_TRUE(raw == 0 || raw == 5000 || raw == 10000)
          << raw << " at " << u << ", " << v;
    }
    const auto range = [&](int from, int to) {
      const cv::Mat part = moved.row(v).colRange(from, to);
      double min = 0.0, max = 0.0;
      cv::minMaxLoc(part, &min, &max);
      return std::make_pair(min, max);
    };
    ASSERT_EQ(range(2, 47), std::make_pair(10000.0, 10000.0)) << v;
    ASSERT_EQ(range(48, 67), std::make_pair(5000.0, 5000.0)) << v;
    ASSERT_EQ(range(68, 69), std::make_pair(0.0, 0.0)) << v;
    ASSERT_EQ(range(70, moved.cols - 3), std::make_pair(10000.0, 10000.0)) << v;
  }
}

// Compares with a rendering from the other pose.
TEST(DepthWarperTest, AgreesWithWhatIsSeenFromThere) {
  Camera distorted = MovedCamera();
  distorted.k1 = 0.2;
  distorted.k2 = -0.3;
  for (const Camera& camera : {MovedCamera(), distorted}) {
    const Renderer renderer(MakeScene("room", 1), camera);
    const Rigid3d there = FindSyntheticPath("handheld")(1.0, 5.0);
    const Rigid3d there_from_here =
        Moved(0.012, -0.008, 0.01) *
        Turned(0.02, Vector3d(0.3, 0.8, 0.5).normalized());
    const Rigid3d here = there * there_from_here;
    const Frame measured = FrameOf(renderer.Render(here).depth);
    const cv::Mat expected = FrameOf(renderer.Render(there).depth).depth;
    DepthWarper mover(camera);
    const cv::Mat& moved = mover.Move(measured, there_from_here);
    int known = 0, wrong = 0, wrong_before = 0;
    double error = 0.0;
    for (int v = 0; v < moved.rows; ++v) {
      for (int u = 0; u < moved.cols; ++u) {
        const double truth = expected.at<uint16_t>(v, u);
        const double z = moved.at<uint16_t>(v, u);
        const double before = measured.depth.at<uint16_t>(v, u);
        wrong_before += std::abs(before - truth) > 0.02 * truth;
        if (z == 0.0) continue;
        ++known;
        if (std::abs(z - truth) > 0.02 * truth) {
          ++wrong;
        } else {
          error += std::abs(z - truth) / truth;
        }
      }
    }
    const int all = moved.rows * moved.cols;
    EXPECT_GT(known, 0.93 * all);  // the rest was out of view or hidden
    EXPECT_GT(wrong_before, 0.1 * all);
    EXPECT_LT(wrong, 0.015 * all);  // at depth edges
    // A quarter of these large pixels on a surface seen at 45 degrees.
    EXPECT_LT(error / known, 2e-3);
  }
}

}  // namespace
}  // namespace rgbd_pose
