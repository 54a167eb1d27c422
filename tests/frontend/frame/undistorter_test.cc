#include "frontend/frame/undistorter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_pose {
namespace {

// Each pixel contains its own position.
Frame Places(const Camera& camera) {
  Frame frame;
  frame.depth.create(camera.height, camera.width, CV_16UC1);
  frame.color.create(camera.height, camera.width, CV_8UC3);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      frame.depth.at<uint16_t>(y, x) = static_cast<uint16_t>(1 + 100 * y + x);
      frame.color.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<uchar>(x), static_cast<uchar>(y), 7);
    }
  }
  return frame;
}

TEST(UndistorterTest, APixelComesFromWhereTheLensHasPutIt) {
  Camera camera = {96,  64,   80.0,  82.0,   47.0, 31.0,
                   0.2, -0.5, 0.003, -0.002, 0.1};
  const Undistorter undistorter(camera);
  EXPECT_FALSE(undistorter.camera().HasDistortion());
  EXPECT_EQ(undistorter.camera().fx, camera.fx);
  const Frame frame = Places(camera);
  const Frame ideal = undistorter.Undistort(frame);
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(20, 15), Eigen::Vector2d(70, 50),
        Eigen::Vector2d(47, 31)}) {
    const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
    const Eigen::Vector2d from =
        camera.Project(undistorter.camera().Unproject(pixel, 1.0));
    EXPECT_EQ(ideal.depth.at<uint16_t>(y, x),
              1 + 100 * std::lround(from.y()) + std::lround(from.x()));
    EXPECT_NEAR(ideal.color.at<cv::Vec3b>(y, x)[0], from.x(), 0.51);
    EXPECT_NEAR(ideal.color.at<cv::Vec3b>(y, x)[1], from.y(), 0.51);
  }
  EXPECT_TRUE(ideal.gray.empty());
}

// A lens whose distortion folds back towards the corners.
TEST(UndistorterTest, NothingIsShownTwice) {
  const Camera camera = {640, 480, 525.0, 525.0, 319.5, 239.5, 0.2, -0.9};
  const Frame ideal = Undistorter(camera).Undistort(Places(camera));
  EXPECT_EQ(ideal.depth.at<uint16_t>(2, 2), 0);
  EXPECT_NE(ideal.depth.at<uint16_t>(240, 320), 0);
}

TEST(UndistorterTest, WithoutDistortionImagesAreTheSame) {
  const Camera camera = {96, 64, 80.0, 82.0, 47.0, 31.0, 0, 0, 0};
  const Frame frame = Places(camera);
  EXPECT_EQ(Undistorter(camera).Undistort(frame).depth.data, frame.depth.data);
}

}  // namespace
}  // namespace rgbd_pose
