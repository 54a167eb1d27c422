#include "apps/export/ros2_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A live camera: nobody knows in advance which times its frames have.
class LiveCamera final : public FrameSource {
 public:
  LiveCamera() { camera_.camera = {160, 120, 131.25, 131.25, 79.5, 59.5}; }
  std::optional<RgbdFrame> Next() override { return std::nullopt; }
  const RgbdCamera& camera() const override { return camera_; }

 private:
  RgbdCamera camera_;
};

class Ros2RecordingTest : public testing::Test {
 protected:
  Ros2RecordingTest() {
    frame_.gray.create(120, 160, CV_8UC1);
    cv::RNG(1).fill(frame_.gray, cv::RNG::UNIFORM, 0, 255);
    frame_.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(10000));
    frame_.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(1, 2, 3));
  }

  // Tracks and records a wall at a time (s).
  void Add(double time) {
    frame_.timestamp = time;
    run_.Add(PreparedFrame(frame_), nullptr);
    recording_->Add(frame_, run_);
  }

  bool IsThere() const { return fs::exists(path_); }
  bool IsPartThere() const { return fs::exists(path_ + ".partial"); }

  const TempFolder folder_;
  const std::string path_ = folder_ / "live.mcap";
  const LiveCamera camera_;
  Frame frame_;
  SequenceRun run_{OdometrySettings(), camera_.camera()};
  std::unique_ptr<Ros2Recording> recording_ =
      std::make_unique<Ros2Recording>(path_, camera_);
};

TEST_F(Ros2RecordingTest, ALiveCamera) {
  for (int i = 0; i < 5; ++i) Add(100.0 + i / 30.0);
  EXPECT_TRUE(IsPartThere());
  EXPECT_FALSE(IsThere());
  EXPECT_THAT(recording_->Finish(),
              HasSubstr("5 poses in the frame odom, 5 images"));
  recording_.reset();
  EXPECT_FALSE(IsPartThere());
  EXPECT_TRUE(IsThere());
}

TEST_F(Ros2RecordingTest, ATimeThatRosDoesNotHaveEndsTheRecordingOnly) {
  for (const double time : {100.0, 100.1, 5e9, 5e9 + 0.1}) Add(time);
  EXPECT_EQ(run_.frames().size(), 4u);
  ExpectInputError([&] { recording_->Finish(); }, {"from 1970 to 2038"});
  recording_.reset();
  EXPECT_FALSE(IsPartThere());
  EXPECT_FALSE(IsThere());
}

// A full disk: the other results of the run need the space, and are written
// while the recording still exists.
TEST_F(Ros2RecordingTest, AFileThatCannotGrowIsRemovedAtOnce) {
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto previous = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small = {10000, before.rlim_max};  // bytes
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  for (int i = 0; i < 12; ++i) Add(100.0 + i / 30.0);
  ExpectInputError([&] { recording_->Finish(); },
                   {path_ + ": writing failed (File too large)"});
  EXPECT_FALSE(IsPartThere());
  EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, previous);
  recording_.reset();
  EXPECT_FALSE(IsThere());
}

TEST_F(Ros2RecordingTest, WithoutAnEndNothingIsLeft) {
  Add(100.0);
  Add(100.1);
  recording_.reset();
  EXPECT_FALSE(IsPartThere());
  EXPECT_FALSE(IsThere());
}

}  // namespace
}  // namespace rgbd_pose
