#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "frontend/files/image_file.h"
#include "frontend/files/jpeg_codec.h"
#include "frontend/sources/open_source.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {

constexpr int kWidth = 32;
constexpr int kHeight = 24;
constexpr double kDepthScale = 1000.0;

inline RgbdCamera SmallCamera() {
  return {{kWidth, kHeight, 30, 30, 15.5, 11.5}, kDepthScale};
}

// Image k differs from the others in each pixel.
inline cv::Mat ColorImage(int k) {
  return cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(10 + k, 60 + k, 110 + k));
}

inline cv::Mat DepthImage(int k) {
  cv::Mat image(kHeight, kWidth, CV_16UC1, cv::Scalar(1000 + k));
  image.at<uint16_t>(0, 0) = 0;
  image.at<uint16_t>(0, 1) = Frame::kNoDepth;
  return image;
}

// Writes an image file, and the folder above it.
inline void WriteImage(const std::string& path, const cv::Mat& image) {
  std::filesystem::create_directories(
      std::filesystem::path(path).parent_path());
  if (std::filesystem::path(path).extension() == ".jpg") {
    WriteFileAtomically(path, EncodeJpeg(image, 95));
  } else {
    WritePngFile(path, image);
  }
}

// A folder with three frames; colour image 2 (1.07 s) has no depth image.
class TumSequenceTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("rgb.txt",
                  "# time image\n"
                  "1.00 rgb/0.png\n"
                  "1.04 rgb/1.jpg\n"
                  "1.07 rgb/2.png\n"
                  "1.10 rgb/3.png\n");
    folder_.Write("depth.txt",
                  "1.005 depth/0.png\n"
                  "1.039 depth/1.png\n"
                  "1.11 depth/3.png\n");
    for (const int k : {0, 1, 3}) {
      const std::string type = k == 1 ? ".jpg" : ".png";
      WriteImage(folder_ / ("rgb/" + std::to_string(k) + type), ColorImage(k));
      WriteImage(folder_ / ("depth/" + std::to_string(k) + ".png"),
                 DepthImage(k));
    }
    options_.path = folder_.path();
    options_.camera = SmallCamera();
  }

  void UseAssociations(const std::string& text) {
    options_.associations_file = folder_.Write("associations.txt", text);
  }

  void ExpectRefused(const std::vector<std::string>& message_parts) {
    ExpectInputError([this] { OpenTum(options_); }, message_parts);
  }

  // Expects that the sequence is accepted, but not its first frame.
  void ExpectReadRefused(const std::vector<std::string>& message_parts) {
    const auto dataset = OpenTum(options_);
    ExpectInputError([&dataset] { dataset->Read(0); }, message_parts);
  }

  TempFolder folder_;
  SourceOptions options_;
};

}  // namespace rgbd_pose
