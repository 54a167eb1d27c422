#include <gtest/gtest.h>

#include <filesystem>

#include "tests/frontend/sources/numbered_folder_fixture.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

using NumberedDatasetTest = NumberedFolderTest;

TEST_F(NumberedDatasetTest, MentionsMasksThatFitNoImage) {
  WriteSevenScenes();
  WriteText("mask/0.png", "");
  EXPECT_NE(OpenSource("auto", WithCamera())
                ->remarks()
                .back()
                .find("has no mask of a colour image"),
            std::string::npos);
}

TEST_F(NumberedDatasetTest, TakesTimesWhereTheyLie) {
  WriteSevenScenes();
  EXPECT_NE(OpenSource("auto", WithCamera())
                ->remarks()
                .front()
                .find("30 frames per second are assumed"),
            std::string::npos);
  fs::remove(folder_ / ("frame-" + Padded(0) + ".depth.png"));
  WriteText("timestamps.txt", "0 10.0\n1 10.05\n2 10.1\n");
  const auto source = OpenSource("auto", WithCamera());
  EXPECT_EQ(source->timestamps(), (std::vector<double>{10.05, 10.1}));
  EXPECT_EQ(source->ground_truth().front().timestamp, 10.05);
  EXPECT_TRUE(source->remarks().empty());
  WriteText("timestamps.txt", "10.0\n10.05\n");
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {"timestamps.txt: has 2 times, but there are 3 colour"});
  WriteText("timestamps.txt", "10.0\n10.05\n10.05\n");
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {"timestamps.txt:3: the time is not after"});
}

TEST_F(NumberedDatasetTest, SaysThatTimesAreProbablyNotInSeconds) {
  WriteSevenScenes();
  WriteText("timestamps.txt", "0\n33\n67\n");
  const auto remarks = OpenSource("auto", WithCamera())->remarks();
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("frames are 33.5 s apart"), std::string::npos);
}

// All recordings of 7-Scenes are of a Kinect, whose rows are read one by one.
TEST_F(NumberedDatasetTest, KnowsTheShutterOfSevenScenes) {
  WriteSevenScenes();
  EXPECT_EQ(OpenSource("auto", WithCamera())->camera().color_shutter.readout,
            0.028);
  SourceOptions options = WithCamera();
  options.camera->color_shutter.is_known = true;  // none, as its file says
  EXPECT_EQ(OpenSource("auto", options)->camera().color_shutter.readout, 0.0);
}

// Their camera is used with a remark, unless the recording has one.
TEST_F(NumberedDatasetTest, SaysThatItTakesTheCameraOfSevenScenes) {
  WriteSevenScenes();
  fs::create_directory(folder_ / "seq-01");
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder_.path())) {
    if (!entry.is_regular_file()) continue;
    fs::rename(entry.path(),
               folder_ / ("seq-01/" + entry.path().filename().string()));
  }
  SourceOptions options = Options();
  options.path = folder_ / "seq-01";
  const auto source = OpenSource("auto", options);
  EXPECT_EQ(source->camera().camera.fx, 585.0);
  EXPECT_NE(source->remarks().back().find("that of the preset 7scenes"),
            std::string::npos);
  // As 3DMatch has it for all recordings of a scene.
  WriteText("camera-intrinsics.txt", kMatrix);
  const auto own = OpenSource("auto", options);
  EXPECT_EQ(own->camera().camera.fx, 30.0);
  EXPECT_EQ(own->remarks().size(), 1u) << "only the times";
}

TEST_F(NumberedDatasetTest, LeavesOutWhatHasNoPartner) {
  WriteSevenScenes();
  fs::remove(folder_ / ("frame-" + Padded(1) + ".depth.png"));
  const auto source = OpenSource("auto", WithCamera());
  EXPECT_EQ(source->timestamps(), (std::vector<double>{0.0, 2.0 / 30.0}));
  EXPECT_EQ(source->unmatched_color(), 1);
  EXPECT_EQ(source->ground_truth().size(), 2u);
}

TEST_F(NumberedDatasetTest, SaysWhichDepthImagesAreMissing) {
  Write("color/000000.png", ColorImage(0));
  Write("depth/000000.jpg", ColorImage(0));  // for display
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {folder_.path(), "none of its 1 colour images",
                    "a depth image depth/123.png of the same number"});
}

TEST_F(NumberedDatasetTest, SaysWhatDepthOfAnotherSizeNeeds) {
  Write("color/000000.png", ColorImage(0));
  Write("depth/000000.png", cv::Mat(kHeight / 2, kWidth / 2, CV_16UC1));
  const auto source = OpenSource("auto", WithCamera());
  ExpectInputError([&] { source->Next()->read(); },
                   {"000000.png: is 16 x 12 pixels, the camera has 32 x 24; if "
                    "another camera took depth, give both"});
}

TEST_F(NumberedDatasetTest, TakesADepthScaleThatIsAskedFor) {
  WriteSevenScenes();
  SourceOptions options = WithCamera();
  options.depth_scale = 5000.0;
  EXPECT_EQ(OpenSource("auto", options)->camera().depth_scale, 5000.0);
  options.depth_scale = 0.0;
  options.camera->depth_scale = 2000.0;
  EXPECT_EQ(OpenSource("auto", options)->camera().depth_scale, 2000.0);
}

TEST_F(NumberedDatasetTest, RefusesWhatCannotBeUsed) {
  WriteSevenScenes();
  ExpectInputError([this] { OpenSource("scannet", WithCamera()); },
                   {folder_.path(), "no colour images", "color/123.jpg"});
  const auto expect_bad_pose = [this](const std::string& text,
                                      const std::string& problem) {
    WriteText("frame-000001.pose.txt", text);
    const auto source = OpenSource("auto", WithCamera());
    ExpectInputError([&] { source->ground_truth(); },
                     {"frame-000001.pose.txt", problem});
  };
  expect_bad_pose("1 0 0 0\n0 1 0 0\n", "needs 4 rows");
  expect_bad_pose("1 0 0 0\n0 1 0 0\n0 0 1 x\n0 0 0 1", ":3");
  expect_bad_pose("1 0 0 0\n0 2 0 0\n0 0 1 0\n0 0 0 1", "not a rotation");
  expect_bad_pose(PoseText(0, "\n") + "1", "more than");
  for (int k = 0; k < kFrames; ++k) {
    fs::rename(folder_ / ("frame-" + Padded(k) + ".depth.png"),
               folder_ / ("frame-" + Padded(k + 10) + ".depth.png"));
  }
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {folder_.path(), "none of its 3 colour images"});
  // A truncated image.
  WriteText("frame-000010.color.png", "");
  const auto source = OpenSource("auto", WithCamera());
  ExpectInputError([&] { source->Next()->read(); }, {"frame-000010.color.png"});
}

}  // namespace
}  // namespace rgbd_pose
