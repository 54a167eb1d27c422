#pragma once

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace rgbd_pose {

// An image that can be packed.
inline cv::Mat SmoothImage(int type) {
  cv::Mat image(48, 61, type);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0,
                  CV_MAT_DEPTH(type) == CV_16U ? 65535 : 255);
  cv::blur(image, image, {9, 9});
  return image;
}

// What OpenCV reads from a file.
inline cv::Mat ByOpenCv(const std::string& file, int flags) {
  return cv::imdecode(std::vector<char>(file.begin(), file.end()), flags);
}

// The file that OpenCV writes; `extension`: such as ".png".
inline std::string EncodedByOpenCv(const std::string& extension,
                                   const cv::Mat& image,
                                   const std::vector<int>& settings = {}) {
  std::vector<uchar> bytes;
  cv::imencode(extension, image, bytes, settings);
  return {bytes.begin(), bytes.end()};
}

inline void ExpectEqual(const cv::Mat& image, const cv::Mat& expected) {
  ASSERT_EQ(image.size(), expected.size());
  ASSERT_EQ(image.type(), expected.type());
  EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0.0);
}

}  // namespace rgbd_pose
