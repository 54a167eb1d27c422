#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/util/text_file.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/frame_stream.h"
#include "tests/frontend/sources/stray_scanner_fixture.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

double MeanDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST_F(StrayScannerTest, ReadsARecording) {
  const SyntheticDataset scene(Phone(4));
  Record(scene);
  const auto source = Open();
  const Camera& camera = source->camera().camera;
  const Camera expected = PhoneCamera(640);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_NEAR(camera.fx, expected.fx, 1e-4);
  EXPECT_NEAR(camera.cx, expected.cx, 1e-4);
  EXPECT_NEAR(camera.cy, expected.cy, 1e-4);
  EXPECT_EQ(source->camera().depth_scale, 1000.0);
  EXPECT_EQ(source->unmatched_color(), 0);
  const Trajectory truth = source->ground_truth();
  ASSERT_EQ(truth.size(), 4u);
  for (int k = 0; k < 4; ++k) {
    const std::optional<RgbdFrame> next = source->Next();
    ASSERT_TRUE(next.has_value());
    const Frame frame = next->read();
    EXPECT_EQ(frame.index, k);
    EXPECT_NEAR(frame.timestamp, scene.timestamp(k), 1e-6);
    EXPECT_EQ(next->timestamp, frame.timestamp);
    EXPECT_EQ(source->timestamps()[k], frame.timestamp);
    EXPECT_EQ(truth[k].timestamp, frame.timestamp);
    const Rigid3d error =
        truth[k].world_from_cam.Inverse() * scene.WorldFromCam(k);
    EXPECT_LT(error.translation.norm(), 1e-6);
    EXPECT_LT(error.Angle(), 1e-5);
    cv::Mat gray;
    cv::cvtColor(frame.color, gray, cv::COLOR_BGR2GRAY);
    EXPECT_EQ(cv::norm(frame.gray, gray, cv::NORM_INF), 0.0);
    cv::cvtColor(scene.Read(k).color, gray, cv::COLOR_BGR2GRAY);
    cv::resize(gray, gray, {640, 480}, 0.0, 0.0, cv::INTER_AREA);
    EXPECT_LT(MeanDifference(frame.gray, gray), 4.0);
  }
  EXPECT_FALSE(source->Next().has_value());
}

TEST_F(StrayScannerTest, AnotherCameraSaysTheSize) {
  RecordPlain(1);
  SourceOptions options;
  options.path = folder_.path();
  options.camera = CameraSetup(PhoneCamera(320));
  const auto source = OpenSource("stray_scanner", options);
  EXPECT_EQ(source->camera().depth_scale, 1000.0);
  const Frame frame = source->Next()->read();
  EXPECT_EQ(frame.gray.size(), cv::Size(320, 240));
  EXPECT_EQ(frame.depth.size(), cv::Size(320, 240));
  options.camera->camera.height = 200;
  ExpectInputError(
      [&] { OpenSource("stray_scanner", options)->Next()->read(); },
      {"rgb.mp4: is 320 x 240 pixels, the camera has 320 x 200"});
}

// The same scene, seen by a camera of 640 x 480.
TEST_F(StrayScannerTest, DepthIsWhereItWasMeasured) {
  Record(SyntheticDataset(Phone(1)));
  SyntheticOptions same = Phone(1);
  same.camera.camera = PhoneCamera(640);
  same.depth_camera.reset();
  const cv::Mat expected = SyntheticDataset(same).Read(0).depth;
  const cv::Mat depth = First().depth;
  int close = 0;
  int between = 0;  // two surfaces
  for (int v = 2; v < 478; ++v) {
    for (int u = 2; u < 638; ++u) {
      const int value = depth.at<uint16_t>(v, u);
      close += std::abs(value - expected.at<uint16_t>(v, u)) <= 4;
      double low, high;
      cv::minMaxLoc(expected(cv::Rect(u - 2, v - 2, 5, 5)), &low, &high);
      between += value < low - 10 || value > high + 10;
    }
  }
  EXPECT_GT(close / (476.0 * 636.0), 0.9);
  EXPECT_LT(between / (476.0 * 636.0), 0.001);
}

TEST_F(StrayScannerTest, LowConfidenceIsNoDepth) {
  RecordPlain(2);
  cv::Mat confidence(kDepthHeight, kDepthWidth, CV_8UC1, cv::Scalar(2));
  confidence.colRange(0, 40) = 0;
  confidence.colRange(40, 80) = 1;
  WriteImage(folder_ / "confidence/000000.png", confidence);
  fs::remove(folder_ / "confidence/000001.png");
  const auto source = Open();
  const cv::Mat depth = source->Next()->read().depth;
  EXPECT_EQ(cv::countNonZero(depth.colRange(0, 100)), 0);
  EXPECT_EQ(cv::countNonZero(depth.colRange(100, 640) != 2000), 0);
  EXPECT_EQ(cv::countNonZero(source->Next()->read().depth != 2000), 0);
}

// Edit lists are how the app hides the first image from players.
TEST_F(StrayScannerTest, TheHiddenFirstImageCounts) {
  RecordPlain(4);
  std::string bytes = ReadTextFile(folder_ / "rgb.mp4");
  const size_t header = bytes.find("mdhd");
  const size_t edit = bytes.find("elst");
  ASSERT_NE(edit, std::string::npos);
  const auto byte = [&](size_t at) {
    return static_cast<unsigned char>(bytes[at]);
  };
  const int per_second = byte(header + 18) << 8 | byte(header + 19);
  const int start = per_second / 60;
  bytes[edit + 18] = static_cast<char>(start >> 8);
  bytes[edit + 19] = static_cast<char>(start & 255);
  folder_.Write("rgb.mp4", bytes);
  cv::VideoCapture player(folder_ / "rgb.mp4", cv::CAP_FFMPEG);
  cv::Mat first;
  player >> first;
  ASSERT_NEAR(cv::mean(first)[0], Level(1)[0], 6.0) << "is not hidden";

  const auto source = Open();
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(cv::mean(source->Next()->read().gray)[0], Level(k)[0], 6.0);
  }
}

TEST_F(StrayScannerTest, PartsAndThreadsGiveTheSameFrames) {
  RecordPlain(16);
  fs::rename(folder_ / "depth/000003.png", folder_ / "depth/3.png");
  fs::remove(folder_ / "depth/000006.png");
  EXPECT_EQ(Open()->unmatched_color(), 1);
  struct {
    const char* range;
    std::vector<int> numbers;
  } const cases[] = {
      {"0-", {0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15}},
      {"2-7:2", {2, 4, 7}},
      {"13-", {14, 15}},
      {"0.1s-0.12s", {7}},
  };
  for (const int threads : {1, 3}) {
    for (const auto& c : cases) {
      SCOPED_TRACE(c.range);
      const auto part = PartOf(Open(), ParseFrameRange(c.range));
      FrameStream stream(part.get(), {}, threads);
      for (const int number : c.numbers) {
        const std::optional<StreamedFrame> next = stream.Next();
        ASSERT_TRUE(next.has_value());
        const Frame& frame = next->frame;
        EXPECT_NEAR(frame.timestamp, 100.0 + number / 60.0, 1e-6);
        EXPECT_NEAR(cv::mean(frame.gray)[0], Level(number)[0], 6.0);
      }
      EXPECT_FALSE(stream.Next().has_value());
    }
  }
}

// Newer versions of the app say how each image was focused.
TEST_F(StrayScannerTest, ImagesAreScaledToOneFocus) {
  const SyntheticDataset first(Phone(2));
  const SyntheticDataset second(Phone(2, 1.02));
  Record(
      2,
      [&](int k) {
        Frame frame = (k == 0 ? first : second).Read(0);
        frame.timestamp = k;
        return frame;
      },
      [](int) { return Rigid3d(); });
  const Camera far = PhoneCamera(kVideoWidth, 1.02);
  const auto difference = [&] {
    const auto source = Open();
    const Frame a = source->Next()->read();
    const Frame b = source->Next()->read();
    const cv::Rect middle(20, 20, 600, 440);
    return cv::Vec2d(MeanDifference(a.gray(middle), b.gray(middle)),
                     MeanDifference(a.depth(middle), b.depth(middle)));
  };
  const cv::Vec2d before = difference();
  std::vector<std::string> lines =
      SplitText(ReadTextFile(folder_ / "odometry.csv"), '\n');
  lines[0] += ", fx, fy, cx, cy, distortion_center_x, distortion_center_y";
  lines[2] +=
      Format(", %.4f, %.4f, %.4f, %.4f, , ", far.fx, far.fy, far.cx, far.cy);
  folder_.Write("odometry.csv", lines[0] + "\n" + lines[1] + "\n" + lines[2]);
  const cv::Vec2d after = difference();
  EXPECT_LT(after[0], 0.4 * before[0]);
  EXPECT_LT(after[1], 0.4 * before[1]);
}

TEST_F(StrayScannerTest, RefusesWhatIsDamaged) {
  const auto write = [this](const char* name, const std::string& text) {
    return [this, name, text] { folder_.Write(name, text); };
  };
  const std::string header = std::string(kStrayHeader) + "\n";
  const std::string row = StrayRowText(100.0, 0, Rigid3d()) + "\n";
  struct {
    std::function<void()> spoil;
    std::vector<std::string> said;
  } const cases[] = {
      {[this] { fs::remove(folder_ / "rgb.mp4"); }, {"rgb.mp4: missing"}},
      {write("rgb.mp4", "nothing of a video"),
       {"rgb.mp4: cannot be read as a video"}},
      {[this] { fs::resize_file(folder_ / "rgb.mp4", 2000); },
       {"rgb.mp4: cannot be read as a video"}},
      {[this] { fs::remove(folder_ / "odometry.csv"); }, {"odometry.csv"}},
      {write("odometry.csv", header + row + StrayRowText(101.0, 1, Rigid3d()) +
                                 "\n" + StrayRowText(102.0, 2, Rigid3d()) +
                                 "\n" + StrayRowText(103.0, 3, Rigid3d())),
       {"rgb.mp4: has 3 images, but odometry.csv has 4 rows"}},
      {[this] { fs::remove(folder_ / "camera_matrix.csv"); },
       {"camera_matrix.csv"}},
      {[this] { fs::remove_all(folder_ / "depth"); },
       {"depth: has no image (000000.png)", ".npy"}},
      {[this] {
         WriteImage(folder_ / "confidence/000000.png",
                    cv::Mat::zeros(10, 10, CV_8UC1));
       },
       {"confidence/000000.png: differs in size from", "depth/000000.png"}},
  };
  RecordPlain(3);
  const fs::path good = folder_ / "good";
  fs::create_directory(good);
  for (const char* name : {"rgb.mp4", "odometry.csv", "camera_matrix.csv"}) {
    fs::copy(folder_ / name, good / name);
  }
  fs::copy(folder_ / "depth", good / "depth");
  fs::copy(folder_ / "confidence", good / "confidence");
  for (const auto& c : cases) {
    c.spoil();
    ExpectInputError([this] { First(); }, c.said);
    fs::copy(
        good, folder_.path(),
        fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }
  First();
}

TEST_F(StrayScannerTest, EndsWhereTheVideoBreaksOff) {
  RecordPlain(12);
  std::string bytes = ReadTextFile(folder_ / "rgb.mp4");
  const size_t frames = bytes.find("mdat");
  const size_t end = bytes.find("moov");
  for (size_t i = frames + (end - frames) / 2; i < end - 4; ++i) bytes[i] = 0;
  folder_.Write("rgb.mp4", bytes);
  const auto source = Open();
  FrameStream stream(source.get(), {}, 2, 0.05);
  int good = 0;
  while (stream.Next().has_value()) ++good;
  EXPECT_GT(good, 3);
  EXPECT_LT(good, 12);
  EXPECT_THAT(stream.stopped(),
              testing::HasSubstr(Format("rgb.mp4: only %d of 12 images can be "
                                        "decoded",
                                        good)));
}

}  // namespace
}  // namespace rgbd_pose
