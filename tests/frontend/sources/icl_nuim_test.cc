#include <gtest/gtest.h>

#include "core/util/text_file.h"
#include "frontend/sources/open_source.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

// ICL-NUIM in TUM's layout: times are the numbers of the images, its world is a
// mirror image, and the y axis of its camera points up (fy < 0).
class IclNuimTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pairs;
    for (int k = 0; k < 2; ++k) {
      const std::string number = std::to_string(k + 1);
      cv::Mat color = ColorImage(k), depth = DepthImage(k);
      color.at<cv::Vec3b>(0, 3) = {255, 255, 255};
      depth.at<uint16_t>(0, 3) = 2000;
      WriteImage(folder_ / ("rgb/" + number + ".png"), color);
      WriteImage(folder_ / ("depth/" + number + ".png"), depth);
      pairs += number + " depth/" + number + ".png " + number + " rgb/" +
               number + ".png\n";
    }
    folder_.Write("associations.txt", pairs);
    folder_.Write("livingRoom0.gt.freiburg",
                  "1 0.1 0.2 0.3 0.70710678 0 0 0.70710678\n"
                  "2 0 1 0 0 0 0 1\n");
    options_.path = folder_.path();
  }

  // The true place of a point one metre before the first camera.
  Eigen::Vector3d Before(const FrameSource& source) const {
    return source.ground_truth().at(0).world_from_cam *
           Eigen::Vector3d(0.0, 0.0, 1.0);
  }

  std::string Camera(double fy) const {
    return folder_.Write(
        "icl.yaml", "Camera.fx: 30\nCamera.fy: " + std::to_string(fy) +
                        "\nCamera.cx: 15.5\nCamera.cy: 10\nCamera.width: 32\n"
                        "Camera.height: 24\n");
  }

  TempFolder folder_;
  SourceOptions options_;
};

TEST_F(IclNuimTest, HasTheTimesOfItsList) {
  options_.camera = CameraSetup(SmallCamera().camera);
  EXPECT_EQ(OpenSource("auto", options_)->timestamps(),
            (std::vector<double>{1.0, 2.0}));
}

// Images are turned upside down, so that paths are in the world of the truth.
TEST_F(IclNuimTest, ACameraWithItsYAxisUpIsTurned) {
  options_.camera = ReadCameraFile(Camera(-31.0));
  const auto source = OpenSource("auto", options_);
  EXPECT_EQ(source->camera().camera.fy, 31.0);
  EXPECT_EQ(source->camera().camera.cy, 23.0 - 10.0);
  const Frame frame = source->Next()->read();
  EXPECT_EQ(frame.gray.at<uint8_t>(kHeight - 1, 3), 255);
  EXPECT_EQ(frame.depth.at<uint16_t>(kHeight - 1, 3), 2000);
  EXPECT_LT((Before(*source) - Eigen::Vector3d(0.1, -0.8, 0.3)).norm(), 1e-6)
      << "as in the file";
}

TEST_F(IclNuimTest, TheTruthIsMirroredForAnotherCamera) {
  options_.camera = ReadCameraFile(Camera(31.0));
  const auto source = OpenSource("auto", options_);
  EXPECT_EQ(source->Next()->read().gray.at<uint8_t>(0, 3), 255);
  EXPECT_LT((Before(*source) - Eigen::Vector3d(0.1, 0.8, 0.3)).norm(), 1e-6);
}

TEST_F(IclNuimTest, ItsOwnCameraIsKnown) {
  const auto source = OpenSource("auto", options_);
  EXPECT_EQ(source->camera().camera.fx, 481.2);
  EXPECT_EQ(source->camera().camera.fy, 480.0);
  ASSERT_EQ(source->remarks().size(), 1u);
  EXPECT_NE(source->remarks()[0].find("fy -480"), std::string::npos);
}

TEST_F(IclNuimTest, OnlyRecordingsAreTurned) {
  ExpectInputError([&] { ResolveCamera(Camera(-31.0)); },
                   {"icl.yaml: fy < 0: only recordings"});
  const std::string path = Camera(-31.0);
  ExpectInputError(
      [&] {
        ReadCameraText(ReadTextFile(path) + "color_readout: 0.02\n", path);
      },
      {"icl.yaml: fy < 0 is supported for registered depth without readouts"});
}

}  // namespace
}  // namespace rgbd_pose
