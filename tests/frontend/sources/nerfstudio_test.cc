#include <gtest/gtest.h>

#include <memory>

#include "frontend/sources/open_source.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

constexpr int kFrames = 3;

constexpr char kCamera[] =
    R"("camera_model": "OPENCV", "w": 32, "h": 24, "fl_x": 30, "fl_y": 31,
       "cx": 16, "cy": 12, "k1": 0.01, "p2": 0.002,
       "depth_unit_scale_factor": )";

class NerfstudioTest : public testing::Test {
 protected:
  // A camera that steps to the right; the last image has no depth.
  NerfstudioTest() {
    for (int k = 0; k < kFrames; ++k) {
      const std::string name = std::to_string(k) + ".png";
      WriteImage(folder_ / ("images/" + name), ColorImage(k));
      WriteImage(folder_ / ("depth/" + name), DepthImage(k));
      frames_ += R"({"file_path": "images/)" + name + R"(", "depth_file_path":
                     "depth/)" +
                 name + R"(", "transform_matrix": [[1, 0, 0, )" +
                 std::to_string(k) + R"(], [0, -1, 0, 0.5], [0, 0, -1, 2],
                                        [0, 0, 0, 1]]}, )";
    }
    frames_ += R"({"file_path": "images/0.png",
                   "transform_matrix": [[1, 0, 0, 0]]})";
  }

  static std::string CameraWith(const char* unit) {
    return kCamera + std::string(unit);
  }

  void WriteTransforms(const std::string& camera, const std::string& frames) {
    folder_.Write("transforms.json",
                  "{" + camera + ", \"frames\": [" + frames + "]}");
  }

  std::unique_ptr<FrameSource> Open() const {
    SourceOptions options;
    options.path = folder_.path();
    return OpenSource("auto", options);
  }

  TempFolder folder_;
  std::string frames_;
};

TEST_F(NerfstudioTest, ReadsImagesCameraAndPoses) {
  WriteTransforms(CameraWith("0.0005"), frames_);
  const auto source = Open();
  const Camera& camera = source->camera().camera;
  EXPECT_EQ(camera.width, 32);
  EXPECT_EQ(camera.fy, 31.0);
  EXPECT_EQ(camera.cx, 15.5) << "of the centre of a pixel";
  EXPECT_EQ(camera.k1, 0.01);
  EXPECT_EQ(camera.p2, 0.002);
  EXPECT_EQ(source->camera().depth_scale, 2000.0);
  EXPECT_EQ(source->unmatched_color(), 1);
  EXPECT_NE(source->remarks().front().find("has no times"), std::string::npos);
  for (int k = 0; k < kFrames; ++k) {
    const Frame frame = source->Next()->read();
    EXPECT_EQ(frame.index, k);
    EXPECT_NEAR(frame.timestamp, k / 30.0, 1e-12);
    EXPECT_EQ(frame.depth.at<uint16_t>(5, 5), 1000 + k);
  }
  EXPECT_FALSE(source->Next().has_value());
  const Trajectory truth = source->ground_truth();
  ASSERT_EQ(truth.size(), static_cast<size_t>(kFrames));
  EXPECT_LT(truth[2].world_from_cam.Angle(), 1e-9) << "y down, z forward";
  EXPECT_EQ(truth[2].world_from_cam.translation, Eigen::Vector3d(2, 0.5, 2));
}

TEST_F(NerfstudioTest, RefusesWhatItCannotUse) {
  WriteTransforms(R"("w": 32)", frames_);
  ExpectInputError([this] { Open(); }, {"contains no camera calibration"});
  WriteTransforms(CameraWith("0.0005"), R"({"file_path": "images/0.png"})");
  ExpectInputError([this] { Open(); }, {"is not a supported recording"});
  SourceOptions options;
  options.path = folder_.path();
  ExpectInputError([&] { OpenSource("nerfstudio", options); },
                   {"transforms.json: none of its frames has a depth_file"});
  const std::string files =
      R"({"file_path": "images/0.png", "depth_file_path": "depth/0.png",
          "transform_matrix": )";
  WriteTransforms(CameraWith("0.0005"),
                  files + "[[1, 0, 0, 0], [0, 1, 0, 0]]}");
  ExpectInputError([this] { Open(); }, {"transform_matrix needs 4 x 4"});
  WriteTransforms(CameraWith("0.0005"),
                  files + "[[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]}");
  ExpectInputError([this] { Open(); }, {"transform_matrix: is not a pose"});
  WriteTransforms(CameraWith("0"), frames_);
  ExpectInputError([this] { Open(); }, {"depth_unit_scale_factor"});
  WriteTransforms("\"camera_model\": \"EQUIRECTANGULAR\", \"fl_x\": 1",
                  frames_);
  ExpectInputError([this] { Open(); }, {"camera_model"});
}

}  // namespace
}  // namespace rgbd_pose
