#include "apps/run/run_tracking.h"

#include <glog/logging.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <opencv2/core.hpp>
#include <utility>

#include "core/util/input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

constexpr int kSourceFrames = 20;
constexpr int kEventAt = 5;  // the event happens when this frame is read

// Frames of a wall, seen by a static camera.
class EventfulSource final : public FrameSource {
 public:
  EventfulSource(bool is_recording, double fy, std::function<void()> event)
      : event_(std::move(event)) {
    camera_.camera = {160, 120, 131.25, fy, 79.5, 59.5, 0, 0, 0};
    cv::RNG random(1);
    frame_.gray.create(120, 160, CV_8UC1);
    random.fill(frame_.gray, cv::RNG::UNIFORM, 0, 255);
    frame_.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(10000));
    for (int i = 0; is_recording && i < kSourceFrames; ++i) {
      timestamps_.push_back(i / 30.0);
    }
  }

  std::optional<RgbdFrame> Next() override {
    if (asked_ == kEventAt) event_();
    if (asked_ == kSourceFrames) return std::nullopt;
    Frame frame = frame_;
    frame.index = asked_++;
    frame.timestamp = frame.index / 30.0;
    frame.gray = frame_.gray.clone();  // a new image, if only by one pixel
    frame.gray.at<uint8_t>(0, frame.index) ^= 1;
    return RgbdFrame{frame.timestamp, [frame] { return frame; }};
  }
  const RgbdCamera& camera() const override { return camera_; }
  std::vector<double> timestamps() const override { return timestamps_; }

 private:
  std::function<void()> event_;
  RgbdCamera camera_;
  Frame frame_;
  std::vector<double> timestamps_;
  int asked_ = 0;
};

class RunTrackingTest : public testing::Test {
 protected:
  // Returns the reason for the early end of the run.
  std::string Track(bool is_recording, std::function<void()> event) {
    EventfulSource source(is_recording, fy_, std::move(event));
    const OdometrySettings settings;
    SequenceRun run(settings, source.camera());
    RunOutputSettings files;
    files.output = folder_ / "run";
    RunOutput output(files, source, settings);
    LiveView view("", {}, source.camera().camera, run);
    std::string stopped =
        TrackSource(&source, 1, &run, &output, nullptr, &view);
    frames_ = static_cast<int>(run.frames().size());
    return stopped;
  }

  TempFolder folder_;
  double fy_ = 131.25;
  int frames_ = 0;
};

// Collects log messages.
class LogLines final : public google::LogSink {
 public:
  LogLines() { google::AddLogSink(this); }
  ~LogLines() override { google::RemoveLogSink(this); }
  void send(google::LogSeverity, const char*, const char*, int,
            const struct std::tm*, const char* message,
            size_t length) override {
    text_.append(message, length).append("\n");
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

TEST_F(RunTrackingTest, WarnsOfAnUnusualCamera) {
  const LogLines log;
  Track(true, [] {});
  EXPECT_EQ(log.text(), "");
  fy_ = 100.0;
  Track(true, [] {});
  EXPECT_THAT(log.text(), HasSubstr("fx 131.25 and fy 100 differ"));
}

TEST_F(RunTrackingTest, GoesToTheEnd) {
  EXPECT_EQ(Track(true, [] {}), "");
  EXPECT_EQ(frames_, kSourceFrames);
  EXPECT_EQ(Track(false, [] {}), "");
  EXPECT_EQ(frames_, kSourceFrames);
}

TEST_F(RunTrackingTest, ASignalEndsItWithWhatThereIs) {
  for (const auto& [signal, name] : {std::pair(SIGINT, "SIGINT"),
                                     {SIGTERM, "SIGTERM"},
                                     {SIGHUP, "SIGHUP"}}) {
    std::signal(signal, SIG_DFL);  // a test in the background ignores SIGINT
    const int number = signal;
    EXPECT_EQ(Track(true, [number] { std::raise(number); }), name);
    EXPECT_GE(frames_, kEventAt);
    EXPECT_LT(frames_, kSourceFrames);
  }
}

TEST_F(RunTrackingTest, WhatIsIgnoredStaysIgnored) {
  std::signal(SIGINT, SIG_IGN);
  EXPECT_EQ(Track(true, [] { std::raise(SIGINT); }), "");
  EXPECT_EQ(frames_, kSourceFrames);
  std::signal(SIGINT, SIG_DFL);
}

TEST_F(RunTrackingTest, ASecondSignalEndsTheProgram) {
  const auto twice = [] {
    std::raise(SIGTERM);
    std::raise(SIGTERM);
  };
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(Track(true, twice), testing::KilledBySignal(SIGTERM), "");
}

TEST_F(RunTrackingTest, AClosedTerminalMaySayItTwice) {
  std::signal(SIGHUP, SIG_DFL);
  const auto twice = [] {
    std::raise(SIGHUP);
    std::raise(SIGHUP);
  };
  EXPECT_EQ(Track(true, twice), "SIGHUP");
}

TEST_F(RunTrackingTest, WhatASourceGaveIsKeptIfItFails) {
  const auto unplug = [] { throw InputError("camera: unplugged"); };
  for (const bool is_recording : {false, true}) {
    EXPECT_THAT(Track(is_recording, unplug), HasSubstr("unplugged"));
    EXPECT_EQ(frames_, kEventAt);
  }
}

}  // namespace
}  // namespace rgbd_pose
