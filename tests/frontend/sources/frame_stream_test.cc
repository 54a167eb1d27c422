#include "frontend/sources/frame_stream.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/util/input_error.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

using std::chrono::milliseconds;

// How long something that must happen may take on a busy machine.
constexpr std::chrono::seconds kPatience(20);

// How long something that must not happen is waited for.
constexpr milliseconds kPause(20);

// Frames of one pixel, the frame's index. `on_read` hears of every read, in
// its thread.
class FakeDataset : public Dataset {
 public:
  explicit FakeDataset(int size) : size_(size) {}

  int size() const override { return size_; }
  double timestamp(int index) const override { return index; }
  const RgbdCamera& camera() const override { return camera_; }

  Frame Read(int index) const override {
    ++reads;
    on_read(index);
    if (unreadable.count(index) > 0) {
      throw InputError("image " + std::to_string(index) + " is broken");
    }
    Frame frame;
    frame.index = index;
    frame.gray = cv::Mat(1, 1, CV_8UC1, cv::Scalar(index));
    return frame;
  }

  std::function<void(int)> on_read = [](int) {};
  std::set<int> unreadable;
  mutable std::atomic<int> reads = 0;

 private:
  int size_;
  RgbdCamera camera_;
};

bool WaitFor(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return true;
}

void ExpectFrame(FrameStream* stream, int index) {
  const Frame frame = stream->Next().frame;
  EXPECT_EQ(frame.index, index);
  EXPECT_EQ(frame.gray.at<uint8_t>(0, 0), index);
}

class FrameStreamTest : public testing::TestWithParam<int> {};  // threads

TEST_P(FrameStreamTest, GivesEachFrameOnceAndInOrder) {
  FakeDataset dataset(60);
  // Later frames of a group of five are read quicker than its first ones.
  dataset.on_read = [](int index) {
    std::this_thread::sleep_for(milliseconds(4 - index % 5));
  };
  FrameStream stream(dataset, nullptr, GetParam());
  for (int i = 0; i < 60; ++i) ExpectFrame(&stream, i);
  EXPECT_EQ(dataset.reads, 60);
  EXPECT_THROW(stream.Next(), std::out_of_range);
}

TEST_P(FrameStreamTest, PreparesFrames) {
  const FakeDataset dataset(20);
  FrameStream stream(
      dataset, [](Frame* frame) { frame->pyramid = {frame->gray.clone()}; },
      GetParam());
  for (int i = 0; i < 20; ++i) {
    const Frame frame = stream.Next().frame;
    ASSERT_EQ(frame.pyramid.size(), 1u);
    EXPECT_EQ(frame.pyramid[0].at<uint8_t>(0, 0), i);
  }
}

TEST_P(FrameStreamTest, RethrowsForExactlyTheUnreadableFrames) {
  FakeDataset dataset(12);
  dataset.unreadable = {0, 3, 4, 11};
  FrameStream stream(dataset, nullptr, GetParam());
  for (int i = 0; i < 12; ++i) {
    if (dataset.unreadable.count(i) > 0) {
      ExpectInputError([&stream] { stream.Next(); },
                       {"image " + std::to_string(i) + " is broken"});
    } else {
      ExpectFrame(&stream, i);
    }
  }
}

TEST_P(FrameStreamTest, SaysHowLongAFrameTook) {
  FakeDataset dataset(4);
  dataset.on_read = [](int index) {
    if (index == 2) std::this_thread::sleep_for(kPause);
  };
  FrameStream stream(dataset, nullptr, GetParam());
  for (int i = 0; i < 4; ++i) {
    const double decode_ms = stream.Next().decode_ms;
    EXPECT_GE(decode_ms, i == 2 ? kPause.count() : 0.0);
  }
}

TEST_P(FrameStreamTest, CanBeGivenUpAtAnyTime) {
  for (int taken = 0; taken < 4; ++taken) {
    FakeDataset dataset(100);
    dataset.unreadable = {5};
    dataset.on_read = [](int) { std::this_thread::sleep_for(milliseconds(1)); };
    {
      FrameStream stream(dataset, nullptr, GetParam());
      for (int i = 0; i < taken; ++i) ExpectFrame(&stream, i);
    }
    const int reads = dataset.reads;
    EXPECT_LT(reads, 100);
    std::this_thread::sleep_for(kPause);
    EXPECT_EQ(dataset.reads, reads) << "somebody goes on reading";
  }
}

TEST_P(FrameStreamTest, AnEmptyDatasetHasNoFrame) {
  const FakeDataset dataset(0);
  FrameStream stream(dataset, nullptr, GetParam());
  EXPECT_THROW(stream.Next(), std::out_of_range);
}

TEST_P(FrameStreamTest, StaysAFewFramesAhead) {
  const int threads = GetParam();
  const int most = threads == 1 ? 0 : threads + 8;
  const FakeDataset dataset(100);
  FrameStream stream(dataset, nullptr, threads);
  for (int taken = 0; taken < 5; ++taken) {
    ASSERT_TRUE(WaitFor([&] { return dataset.reads == taken + most; }));
    std::this_thread::sleep_for(kPause);
    EXPECT_EQ(dataset.reads, taken + most);
    ExpectFrame(&stream, taken);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, FrameStreamTest, testing::Values(1, 2, 5));

TEST(FrameStreamThreadsTest, OneThreadIsTheCallingOne) {
  FakeDataset dataset(3);
  const std::thread::id caller = std::this_thread::get_id();
  dataset.on_read = [caller](int) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
  };
  FrameStream stream(dataset, nullptr, 1);
  for (int i = 0; i < 3; ++i) ExpectFrame(&stream, i);
}

// Two reads that wait for each other need two threads that read.
TEST(FrameStreamThreadsTest, TheCallingThreadReadsInsteadOfSleeping) {
  FakeDataset dataset(2);
  std::promise<void> begun[2];
  std::future<void> has_begun[2] = {begun[0].get_future(),
                                    begun[1].get_future()};
  dataset.on_read = [&](int index) {
    begun[index].set_value();
    EXPECT_EQ(has_begun[1 - index].wait_for(kPatience),
              std::future_status::ready)
        << "nobody reads the other frame";
  };
  FrameStream stream(dataset, nullptr, 2);
  for (int i = 0; i < 2; ++i) ExpectFrame(&stream, i);
}

}  // namespace
}  // namespace rgbd_pose
