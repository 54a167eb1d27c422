#include "frontend/bags/ros_image.h"

#include <cmath>
#include <cstring>

#include "frontend/files/jpeg_codec.h"
#include "frontend/files/png_codec.h"
#include "tests/frontend/bags/ros1_bag_fixture.h"

namespace rgbd_pose {
namespace {

TEST_F(Ros1BagTest, ReadsColours) {
  struct Case {
    const char* encoding;
    cv::Scalar value;
    int type;
    cv::Vec3b bgr;
  };
  for (const Case& c : {Case{"rgb8", {30, 20, 10}, CV_8UC3, {10, 20, 30}},
                        Case{"bgr8", {10, 20, 30}, CV_8UC3, {10, 20, 30}},
                        Case{"rgba8", {30, 20, 10, 255}, CV_8UC4, {10, 20, 30}},
                        Case{"bgra8", {10, 20, 30, 255}, CV_8UC4, {10, 20, 30}},
                        Case{"mono8", {20}, CV_8UC1, {20, 20, 20}}}) {
    Begin();
    const cv::Mat image(kHeight, kWidth, c.type, c.value);
    Write(kColor, kStart, MakeImage(image, c.encoding, kStart));
    Write(kDepth, kStart, MakeImage(DepthImage(0), "16UC1", kStart));
    SourceOptions options = Options();
    options.keep_color = true;
    const Frame frame = OpenSource("rosbag", options)->Next()->read();
    EXPECT_EQ(frame.color.at<cv::Vec3b>(3, 4), c.bgr) << c.encoding;
    EXPECT_NEAR(frame.gray.at<uint8_t>(3, 4),
                0.114 * c.bgr[0] + 0.587 * c.bgr[1] + 0.299 * c.bgr[2], 1.0);
  }
}

// One colour, as the pixels of a pattern show it.
TEST_F(Ros1BagTest, ReadsPatternsOfColourFilters) {
  const cv::Vec3b bgr = {10, 120, 230};
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    cv::Mat image(kHeight, kWidth, CV_8UC1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const char filter = pattern[2 * (y % 2) + x % 2];
        image.at<uint8_t>(y, x) = bgr[filter == 'b'   ? 0
                                      : filter == 'g' ? 1
                                                      : 2];
      }
    }
    Begin();
    Write(kColor, kStart, MakeImage(image, "bayer_" + pattern + "8", kStart));
    WriteDepth(0);
    SourceOptions options = Options();
    options.keep_color = true;
    const Frame frame = OpenSource("rosbag", options)->Next()->read();
    EXPECT_EQ(frame.color.at<cv::Vec3b>(3, 4), bgr) << pattern;
    EXPECT_NEAR(frame.gray.at<uint8_t>(3, 4), 140, 1) << pattern;
  }
}

TEST_F(Ros1BagTest, ReadsPairsOfPixelsWithOneChroma) {
  const cv::Vec4b uyvy = {90, 81, 240, 145};  // pure red, then brighter
  const cv::Vec4b yuyv = {81, 90, 145, 240};
  for (const auto& [encoding, pair] : {std::pair("yuv422", uyvy),
                                       {"uyvy", uyvy},
                                       {"yuv422_yuy2", yuyv},
                                       {"yuyv", yuyv}}) {
    cv::Mat image(kHeight, kWidth / 2, CV_8UC4, cv::Scalar(pair));
    Begin();
    Write(kColor, kStart, MakeImage(image.reshape(2), encoding, kStart));
    WriteDepth(0);
    SourceOptions options = Options();
    options.keep_color = true;
    const Frame frame = OpenSource("rosbag", options)->Next()->read();
    const auto red = frame.color.at<cv::Vec3b>(3, 4);
    EXPECT_LT(red[0], 3) << encoding;
    EXPECT_LT(red[1], 3) << encoding;
    EXPECT_GT(red[2], 250) << encoding;
    EXPECT_EQ(frame.gray.at<uint8_t>(3, 4), 81) << encoding;
    EXPECT_EQ(frame.gray.at<uint8_t>(3, 5), 145) << encoding;
  }
}

// Drivers publish what their sensor sends beside the colours made of it.
TEST_F(Ros1BagTest, PrefersColoursToAPattern) {
  Begin();
  Write("/camera/rgb/image_bayer", kStart,
        MakeImage(cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(77)),
                  "bayer_grbg8", kStart));
  WriteColor(0);
  WriteDepth(0);
  EXPECT_NE(Source()->Next()->read().gray.at<uint8_t>(5, 5), 77);
}

TEST_F(Ros1BagTest, ReadsBigEndianDepth) {
  Begin();
  WriteColor(0);
  cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(0x3412));
  sensor_msgs::Image message = MakeImage(depth, "16UC1", kStart + 0.004);
  message.is_bigendian = 1;
  Write(kDepth, kStart, message);
  EXPECT_EQ(Source()->Next()->read().depth.at<uint16_t>(5, 5), 0x1234);
}

TEST_F(Ros1BagTest, ReadsMetres) {
  Begin();
  for (int k = 0; k < kFrames; ++k) {
    WriteColor(k);
    cv::Mat metres;
    DepthImage(k).convertTo(metres, CV_32F, 0.001);
    metres.at<float>(0, 0) = NAN;
    metres.at<float>(0, 1) = 13.2F;  // too far
    Write("/camera/depth/image", StampOf(k) + 0.02,
          MakeImage(metres, "32FC1", StampOf(k) + 0.004));
  }
  ExpectFrames(Source().get(), kFrames, 5000.0);
  const Frame frame = Source()->Next()->read();
  EXPECT_EQ(frame.depth.at<uint16_t>(0, 0), 0);
  EXPECT_EQ(frame.depth.at<uint16_t>(0, 1), 0);

  SourceOptions options = Options();
  options.depth_scale = 2000.0;
  ExpectFrames(OpenSource("auto", options).get(), kFrames, 2000.0);
}

TEST_F(Ros1BagTest, RefusesMillimetresThatAreCalledMetres) {
  for (const bool is_far : {false, true}) {  // infinite: farther than measured
    Begin();
    WriteColor(0);
    cv::Mat depth;
    DepthImage(0).convertTo(depth, CV_32F, is_far ? 0.001 : 1.0);
    if (is_far) depth.rowRange(0, kHeight - 4).setTo(INFINITY);
    Write("/camera/depth/image", kStart,
          MakeImage(depth, "32FC1", kStart + 0.004));
    if (is_far) {
      EXPECT_GT(Source()->Next()->read().DepthAt(5, kHeight - 2), 0.0);
    } else {
      ExpectRefused({"/camera/depth/image at 1000.004", "beyond 100 m",
                     "(REP 118)", "16UC1"});
    }
  }
}

TEST_F(Ros1BagTest, ReadsCompressedImages) {
  for (const bool is_metric : {false, true}) {
    Begin();
    for (int k = 0; k < kFrames; ++k) {
      const std::string file =
          k % 2 == 0 ? EncodeJpeg(ColorImage(k), 95) : EncodePng(ColorImage(k));
      const std::vector<uchar> bytes(file.begin(), file.end());
      Write(std::string(kColor) + "/compressed", StampOf(k),
            MakeCompressed("bgr8; jpeg compressed bgr8", bytes, StampOf(k)));
      // compressed_depth_image_transport writes depth as A / z + B.
      const float a = 10100.0F;
      const float b = -100.0F;
      cv::Mat depth = DepthImage(k);
      if (is_metric) {
        depth.forEach<uint16_t>([&](uint16_t& raw, const int*) {
          if (raw > 0) raw = std::lround(a / (raw * 0.001F) + b);
        });
      }
      const std::string png = EncodePng(depth);
      std::vector<uchar> message(12);
      std::memcpy(&message[4], &a, 4);
      std::memcpy(&message[8], &b, 4);
      message.insert(message.end(), png.begin(), png.end());
      Write(std::string(kDepth) + "/compressedDepth", StampOf(k),
            MakeCompressed(is_metric ? "32FC1; compressedDepth png"
                                     : "16UC1; compressedDepth png",
                           message, StampOf(k) + 0.004));
    }
    if (!is_metric) {
      constexpr double kOfJpeg = 3.0;  // gray levels
      ExpectFrames(Source().get(), kFrames, 1000.0, kOfJpeg);
      continue;
    }
    const Frame frame = Source()->Next()->read();
    EXPECT_NEAR(frame.DepthAt(5, 5), 1.0, 2e-4);  // precision of the packing
    EXPECT_EQ(frame.DepthAt(0, 0), 0.0);
  }
}

TEST_F(Ros1BagTest, RefusesWrongImages) {
  Begin();
  Write(kColor, kStart,
        MakeImage(cv::Mat(kHeight, kWidth, CV_16UC1), "bayer_rggb16", kStart));
  WriteDepth(0);
  ExpectRefused({"has no readable colour images"});
  SourceOptions options = Options();
  options.topics = {kColor, kDepth};
  ExpectInputError([&] { OpenSource("auto", options)->Next()->read(); },
                   {"encoding 'bayer_rggb16'", "rgb8", kColor});

  Begin();
  Write(kColor, kStart,
        MakeImage(cv::Mat(kHeight, kWidth - 1, CV_8UC2), "yuv422", kStart));
  WriteDepth(0);
  ExpectRefused({kColor, "31 pixels wide, but yuv422 has pairs"});

  Begin();
  WriteColor(0);
  Write(kDepth, kStart,
        MakeImage(cv::Mat(kHeight / 2, kWidth / 2, CV_16UC1), "16UC1", kStart));
  ExpectRefused({kDepth, "16 x 12", "32 x 24"});

  Begin();
  WriteColor(0);
  sensor_msgs::Image cut = MakeImage(DepthImage(0), "16UC1", kStart);
  cut.data.resize(100);
  Write(kDepth, kStart, cut);
  ExpectRefused({kDepth, "holds 100 bytes, too few"});
}

}  // namespace
}  // namespace rgbd_pose
