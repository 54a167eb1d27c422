#include "frontend/bags/bag_topics.h"

#include <string>
#include <utility>

#include "tests/frontend/bags/ros1_bag_fixture.h"

namespace rgbd_pose {
namespace {

TEST_F(Ros1BagTest, PrefersRegisteredDepthAndRawImages) {
  Open();
  WriteAll();
  Write("/camera/depth/image_raw", kStart,
        MakeImage(DepthImage(50), "16UC1", kStart));
  Write("/camera/ir/image_raw", kStart,
        MakeImage(cv::Mat(kHeight, kWidth, CV_8UC1), "mono8", kStart));
  Write("/camera/rgb/image_color/compressed", kStart,
        MakeCompressed("bgr8; jpeg", {1, 2, 3}, kStart));
  const auto source = Source();
  ExpectFrames(source.get(), kFrames);
  ASSERT_EQ(source->remarks().size(), 1u);
  EXPECT_NE(source->remarks()[0].find(kDepth), std::string::npos);
}

TEST_F(Ros1BagTest, AsksWhichTopicsWhereSeveralWillDo) {
  Open();
  WriteAll();
  Write("/other/depth_registered/image", kStart,
        MakeImage(DepthImage(50), "16UC1", kStart));
  ExpectRefused({"a.bag: both " + std::string(kDepth),
                 "/other/depth_registered/image", "topics=COLOUR,DEPTH",
                 kColor});
  SourceOptions options = Options();
  options.topics = {kColor, kDepth};
  ExpectFrames(OpenSource("auto", options).get(), kFrames);
  options.topics.emplace_back("/camera/rgb/camera_info");
  ExpectFrames(OpenSource("auto", options).get(), kFrames);
  options.topics[1] = "/nothing";
  ExpectInputError([&] { OpenSource("auto", options); },
                   {"no topic '/nothing'", kDepth});
  options.topics[1] = "/camera/rgb/camera_info";
  ExpectInputError([&] { OpenSource("auto", options); },
                   {"of the unsuitable type sensor_msgs/CameraInfo"});
  options.topics = {kColor};
  ExpectInputError([&] { OpenSource("auto", options); }, {"COLOUR,DEPTH"});
}

// Infrared, thermal, disparity and confidence have the encodings of depth.
TEST_F(Ros1BagTest, TakesNoOtherImagesForDepth) {
  const cv::Mat metres(kHeight, kWidth, CV_32FC1, cv::Scalar(1.0));
  const std::pair<const char*, const char*> others[] = {
      {"/ir/image_raw", "mono16"},
      {"/thermal/image_raw", "16UC1"},
      {"/stereo/disparity_image", "32FC1"},
      {"/zed/confidence/confidence_map", "32FC1"}};
  for (const auto& [topic, encoding] : others) {
    for (const bool has_depth : {false, true}) {
      Begin();
      for (int k = 0; k < 3; ++k) {
        WriteColor(k);
        const std::string text = encoding;
        Write(topic, StampOf(k) + 0.011,
              MakeImage(text == "32FC1" ? metres : DepthImage(k), text,
                        StampOf(k) + 0.004));
        if (has_depth) WriteDepth(k);
      }
      if (has_depth) {
        ExpectFrames(Source().get(), 3);
      } else {
        ExpectRefused({"has no readable depth images", topic});
      }
    }
  }
}

TEST_F(Ros1BagTest, SaysWhatIsTakenForDepthIfItsNameDoesNot) {
  Begin();
  for (int k = 0; k < 3; ++k) {
    WriteColor(k);
    Write("/oak/stereo/image_raw", StampOf(k) + 0.011,
          MakeImage(DepthImage(k), "16UC1", StampOf(k) + 0.004));
  }
  const auto source = Source();
  ExpectFrames(source.get(), 3);
  ASSERT_EQ(source->remarks().size(), 1U);
  EXPECT_NE(source->remarks()[0].find("depth /oak/stereo/image_raw"),
            std::string::npos);
}

// As openni2 does with depth and the ZED with colour.
TEST_F(Ros1BagTest, TakesOneOfTopicsThatShowTheSame) {
  Begin();
  for (int k = 0; k < 3; ++k) {
    WriteColor(k);
    WriteDepth(k);
    Write("/camera/left/image_color", StampOf(k) + 0.01,
          MakeImage(ColorImage(k), "bgr8", StampOf(k)));
    cv::Mat metres;
    DepthImage(k).convertTo(metres, CV_32FC1, 0.001);
    Write("/camera/depth_registered/image", StampOf(k) + 0.011,
          MakeImage(metres, "32FC1", StampOf(k) + 0.004));
  }
  SourceOptions options = Options();
  options.topics = {kColor, kDepth};
  ExpectFrames(OpenSource("auto", options).get(), 3);
  const auto source = Source();
  int frames = 0;
  while (source->Next()) ++frames;
  EXPECT_EQ(frames, 3);
  ASSERT_EQ(source->remarks().size(), 1U);
  EXPECT_NE(source->remarks()[0].find("choose others"), std::string::npos);
}

TEST_F(Ros1BagTest, RefusesWhatIsNoRecording) {
  Begin();
  ExpectRefused(
      {"a.bag: has no readable colour images", "/camera/rgb/camera_info"});

  Begin();
  WriteColor(0);
  ExpectRefused({"has no readable depth images", kColor});

  Open();
  WriteFrames(1);
  ExpectRefused({"contains no camera calibration"});

  Open();
  ExpectRefused({"has no readable colour images", "topics: none"});

  Open();
  Write(kColor, kStart,
        MakeImage(cv::Mat(kHeight, kWidth, CV_16UC1), "bayer_rggb16", kStart));
  WriteDepth(0);
  ExpectRefused(
      {"has no readable colour images", "image_color 'bayer_rggb16'"});

  Open();
  WriteFrames(1);
  Write("/other/camera_info", kStart, MakeInfo(SmallCamera().camera));
  ExpectRefused({"has no CameraInfo next to", "/other/camera_info", "topics="});

  Open();
  Camera none = SmallCamera().camera;
  none.fx = none.fy = 0.0;
  Write("/camera/rgb/camera_info", kStart, MakeInfo(none));
  WriteFrames(1);
  ExpectRefused({"camera_info: the camera is not calibrated (K is 0)"});
}

}  // namespace
}  // namespace rgbd_pose
