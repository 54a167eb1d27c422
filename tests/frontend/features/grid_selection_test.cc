#include "frontend/features/grid_selection.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

// Keypoints all over an image, 8 px apart, all with depth.
size_t NumSelected(const cv::Size& size, int max_count) {
  Frame frame;
  frame.depth_scale = 1000.0;
  frame.gray = cv::Mat(size, CV_8UC1, cv::Scalar(0));
  frame.depth = cv::Mat(size, CV_16UC1, cv::Scalar(1000));
  std::vector<cv::KeyPoint> keypoints;
  for (int v = 4; v < size.height; v += 8) {
    for (int u = 4; u < size.width; u += 8) {
      keypoints.emplace_back(static_cast<float>(u), static_cast<float>(v), 7.0F,
                             -1.0F, 1.0F + static_cast<float>((u * v) % 97));
    }
  }
  return SelectOverGrid(keypoints, frame, max_count, {}).size();
}

TEST(GridSelectionTest, SelectsAboutAsManyAsWanted) {
  for (const cv::Size& size :
       {cv::Size(320, 240), cv::Size(640, 480), cv::Size(1920, 1080)}) {
    for (const int wanted : {100, 300, 600}) {
      const size_t selected = NumSelected(size, wanted);
      EXPECT_GE(selected, 0.9 * wanted) << size << " " << wanted;
      EXPECT_LE(selected, 2.2 * wanted) << size << " " << wanted;
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
