#include "frontend/bags/bag_topics.h"

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
  ExpectFrames(Source().get(), kFrames);
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

TEST_F(Ros1BagTest, RefusesWhatIsNoRecording) {
  Open();
  WriteInfo();
  ExpectRefused(
      {"a.bag: has no readable colour images", "/camera/rgb/camera_info"});

  Open();
  WriteInfo();
  WriteColor(0);
  ExpectRefused({"has no readable depth images", kColor});

  Open();
  WriteColor(0);
  WriteDepth(0);
  ExpectRefused({"contains no camera calibration"});

  Open();
  ExpectRefused({"has no readable colour images", "topics: none"});

  Open();
  Write(kColor, kStart,
        MakeImage(cv::Mat(kHeight, kWidth, CV_8UC1), "bayer_rggb8", kStart));
  WriteDepth(0);
  ExpectRefused({"has no readable colour images", "image_color 'bayer_rggb8'"});

  Open();
  WriteColor(0);
  WriteDepth(0);
  Write("/other/camera_info", kStart, MakeInfo(SmallCamera().camera));
  ExpectRefused({"has no CameraInfo next to", "/other/camera_info", "topics="});

  Open();
  Camera none = SmallCamera().camera;
  none.fx = none.fy = 0.0;
  Write("/camera/rgb/camera_info", kStart, MakeInfo(none));
  WriteColor(0);
  WriteDepth(0);
  ExpectRefused({"camera_info: the camera is not calibrated (K is 0)"});
}

}  // namespace
}  // namespace rgbd_pose
