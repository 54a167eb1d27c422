#include <gtest/gtest.h>

#include <filesystem>

#include "frontend/sources/open_source.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"
#ifdef RGBD_POSE_HAS_OPENEXR
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#endif

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// A folder as the app exports it: portrait images, depth in a smaller size.
class Record3dTest : public testing::Test {
 protected:
  void SetUp() override {
#ifndef RGBD_POSE_HAS_OPENEXR
    GTEST_SKIP() << "built without OpenEXR";
#endif
    fs::create_directory(folder_ / "depth");
    for (int k = 0; k < 3; ++k) {
      const std::string number = std::to_string(k);
      WriteImage(folder_ / ("rgb/" + number + ".jpg"),
                 cv::Mat(1280, 960, CV_8UC3, cv::Scalar(10, 60, 110)));
      WriteDepth(folder_ / ("depth/" + number + ".exr"), 1.5F + 0.5F * k);
    }
    WriteMetadata("[0, 0.1, 0.3]");
    options_.path = folder_.path();
  }

  void WriteMetadata(const std::string& times) const {
    folder_.Write("metadata.json",
                  R"({"w": 960, "h": 1280, "dw": 192, "dh": 256, "fps": 60,
                      "K": [936, 0, 0, 0, 936, 0, 481.5, 641.5, 1],
                      "frameTimestamps": )" +
                      times + R"(,
                      "poses": [[0, 0, 0, 1, 1, 2, 3], [0, 0, 0, 1, 1, 2, 4],
                                [0, 0, 0, 1, 1, 2, 5]]})");
  }

  // The same depth (m) everywhere but in the first column, where there is none.
  static void WriteDepth(const std::string& path, float metres) {
#ifdef RGBD_POSE_HAS_OPENEXR
    Imf::Array2D<float> pixels(256, 192);
    for (int v = 0; v < 256; ++v) {
      for (int u = 0; u < 192; ++u) pixels[v][u] = u == 0 ? 0.0F : metres;
    }
    Imf::Header header(192, 256);
    header.channels().insert("R", Imf::Channel(Imf::FLOAT));
    Imf::OutputFile file(path.c_str(), header);
    Imf::FrameBuffer buffer;
    buffer.insert("R",
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&pixels[0][0]),
                             sizeof(float), 192 * sizeof(float)));
    file.setFrameBuffer(buffer);
    file.writePixels(256);
#else
    static_cast<void>(path);
    static_cast<void>(metres);
#endif
  }

  TempFolder folder_;
  SourceOptions options_;
};

TEST_F(Record3dTest, IsReadAsTheAppExportsIt) {
  const auto source = OpenSource("auto", options_);
  EXPECT_EQ(source->timestamps(), (std::vector<double>{0.0, 0.1, 0.3}));
  const Camera& camera = source->camera().camera;
  EXPECT_EQ(cv::Size(camera.width, camera.height), cv::Size(480, 640));
  EXPECT_EQ(camera.fx, 468.0);
  EXPECT_EQ(camera.cx, 240.5) << "pixel centres are at integers";
  const Frame frame = source->Next()->read();
  EXPECT_EQ(frame.gray.size(), cv::Size(480, 640));
  EXPECT_EQ(frame.depth.size(), cv::Size(480, 640));
  EXPECT_NEAR(frame.DepthAt(240, 320), 1.5, 1e-4);
  EXPECT_EQ(frame.DepthAt(0, 320), 0.0);
  EXPECT_NEAR(source->Next()->read().DepthAt(240, 320), 2.0, 1e-4);
}

// A camera of ARKit looks along its negative z axis.
TEST_F(Record3dTest, HasThePathOfArKit) {
  const Trajectory path = OpenSource("auto", options_)->ground_truth();
  ASSERT_EQ(path.size(), 3u);
  const Eigen::Vector3d before =
      path[1].world_from_cam * Eigen::Vector3d(0.0, 1.0, 2.0);
  EXPECT_LT((before - Eigen::Vector3d(1.0, 2.0 - 1.0, 4.0 - 2.0)).norm(), 1e-9);
}

TEST_F(Record3dTest, LeavesOutWhatHasNoDepth) {
  fs::remove(folder_ / "depth/1.exr");
  const auto source = OpenSource("auto", options_);
  EXPECT_EQ(source->timestamps(), (std::vector<double>{0.0, 0.3}));
  EXPECT_EQ(source->unmatched_color(), 1);
}

TEST_F(Record3dTest, DoesNotEndWhereAnImageIsMissing) {
  fs::remove(folder_ / "rgb/1.jpg");
  EXPECT_EQ(OpenSource("auto", options_)->timestamps(),
            (std::vector<double>{0.0, 0.3}));
}

TEST_F(Record3dTest, RefusesWhatIsDamaged) {
  WriteMetadata("[0, 0.1, 0.1]");
  ExpectInputError([this] { OpenSource("auto", options_); },
                   {"metadata.json: frameTimestamps: the time of image 2"});
  WriteMetadata("[0, soon, 1]");
  ExpectInputError([this] { OpenSource("auto", options_); },
                   {"metadata.json:3: 'soon' is not a finite number"});
  folder_.Write("metadata.json", "{}");
  ExpectInputError([this] { OpenSource("auto", options_); },
                   {"metadata.json", "K is missing"});
  WriteMetadata("[0, 0.1, 0.3]");
  folder_.Write("depth/0.exr", "no image");
  const auto source = OpenSource("auto", options_);
  ExpectInputError([&] { source->Next()->read(); },
                   {"depth/0.exr: cannot be read as OpenEXR"});
}

}  // namespace
}  // namespace rgbd_pose
