#include "frontend/sources/latest_frame.h"

#include <gtest/gtest.h>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// A camera whose frames arrive when the test allows it.
class FakeCamera final : public FrameSource {
 public:
  std::optional<RgbdFrame> Next() override {
    std::unique_lock<std::mutex> lock(mutex_);
    ++num_asked_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return num_asked_ <= num_allowed_; });
    const int number = num_asked_;
    if (number == fails_at_) throw InputError("unplugged");
    if (number > last_) return std::nullopt;
    // With one inertial sample of the same stamp.
    return RgbdFrame{number / 30.0,
                     [number] {
                       Frame frame;
                       frame.timestamp = number / 30.0;
                       return frame;
                     },
                     {ImuSample{number / 30.0}}};
  }
  const RgbdCamera& camera() const override { return camera_; }

  // Allows frames up to this one, and waits until they have arrived.
  void Allow(int number) {
    std::unique_lock<std::mutex> lock(mutex_);
    num_allowed_ = number;
    changed_.notify_all();
    changed_.wait(lock, [this] { return num_asked_ > num_allowed_; });
  }
  // Allows all frames; `last` is the last one.
  void AllowAll(int last) {
    const std::lock_guard<std::mutex> lock(mutex_);
    num_allowed_ = last + 1;
    last_ = last;
    changed_.notify_all();
  }
  void FailAt(int number) {
    const std::lock_guard<std::mutex> lock(mutex_);
    num_allowed_ = number;
    fails_at_ = number;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int num_asked_ = 0;
  int num_allowed_ = 0;
  int last_ = 1 << 30;
  int fails_at_ = 0;
  RgbdCamera camera_;
};

class LatestFrameTest : public testing::Test {
 protected:
  // Expects a frame, and the inertial samples since the one before.
  void ExpectNext(int number, int index, size_t samples = 1) {
    const std::optional<RgbdFrame> next = frames_.Next();
    ASSERT_TRUE(next.has_value());
    ASSERT_EQ(next->imu.size(), samples);
    for (size_t k = 0; k < samples; ++k) {
      EXPECT_EQ(next->imu[k].stamp, (number - (samples - 1.0 - k)) / 30.0);
    }
    EXPECT_EQ(next->timestamp, number / 30.0);
    EXPECT_EQ(next->read().index, index);
    EXPECT_EQ(next->read().timestamp, number / 30.0);
  }

  FakeCamera* camera_ = new FakeCamera;  // owned by frames_
  LatestFrame frames_{std::unique_ptr<FrameSource>(camera_)};
};

TEST_F(LatestFrameTest, DropsAllButTheNewest) {
  camera_->Allow(1);
  ExpectNext(1, 0);
  EXPECT_EQ(frames_.dropped(), 0);
  camera_->Allow(5);  // nobody asks for 2, 3 and 4
  ExpectNext(5, 1, /*samples=*/4);
  EXPECT_EQ(frames_.dropped(), 3);
  camera_->Allow(6);
  ExpectNext(6, 2);
  EXPECT_EQ(frames_.dropped(), 3);
  camera_->AllowAll(6);
  EXPECT_FALSE(frames_.Next().has_value());
  EXPECT_FALSE(frames_.Next().has_value());
}

TEST_F(LatestFrameTest, GivesTheLastFrameBeforeItEnds) {
  camera_->AllowAll(1);
  ExpectNext(1, 0);
  EXPECT_FALSE(frames_.Next().has_value());
}

TEST_F(LatestFrameTest, PassesOnWhatTheCameraThrows) {
  camera_->Allow(1);
  camera_->FailAt(2);
  ExpectNext(1, 0);
  EXPECT_THROW(frames_.Next(), InputError);
  EXPECT_FALSE(frames_.Next().has_value());
}

TEST_F(LatestFrameTest, ClosesWithoutBeingAsked) { camera_->AllowAll(1000); }

}  // namespace
}  // namespace rgbd_pose
