#include "frontend/sources/frame_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <set>
#include <thread>

#include "core/util/input_error.h"
#include "tests/support/expect_input_error.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace rgbd_pose {
namespace {

using std::chrono::milliseconds;

// Limit for events that must happen, even on a busy machine.
constexpr std::chrono::seconds kPatience(20);

// Waiting time for events that must not happen.
constexpr milliseconds kPause(20);

// Frames of one pixel with the frame's index. `on_read` is called for every
// read, in the reading thread.
class FakeSource : public FrameSource {
 public:
  explicit FakeSource(int size) : size_(size) {}

  const RgbdCamera& camera() const override { return camera_; }

  std::optional<RgbdFrame> Next() override {
    EXPECT_FALSE(is_asked.exchange(true)) << "asked by two threads at once";
    const int index = next_;
    on_ask(index);
    std::optional<RgbdFrame> next;
    if (next_ < size_) {
      next = RgbdFrame{1.0 * index, [this, index] { return Read(index); }};
      ++next_;
    }
    is_asked = false;
    if (missing.count(index) > 0) throw InputError("the cable is loose");
    return next;
  }

  Frame Read(int index) {
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
  std::function<void(int)> on_ask = [](int) {};
  std::set<int> unreadable;
  std::set<int> missing;  // frames that the source fails to return
  std::atomic<int> reads = 0;
  std::atomic<bool> is_asked = false;

 private:
  int size_;
  int next_ = 0;
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
  const Frame frame = stream->Next().value().frame;
  EXPECT_EQ(frame.index, index);
  EXPECT_EQ(frame.gray.at<uint8_t>(0, 0), index);
}

class FrameStreamTest : public testing::TestWithParam<int> {};  // threads

TEST_P(FrameStreamTest, GivesEachFrameOnceAndInOrder) {
  FakeSource source(60);
  // In a group of five frames, later frames are read faster.
  source.on_read = [](int index) {
    std::this_thread::sleep_for(milliseconds(4 - index % 5));
  };
  FrameStream stream(&source, nullptr, GetParam());
  for (int i = 0; i < 60; ++i) ExpectFrame(&stream, i);
  EXPECT_EQ(source.reads, 60);
  FakeSource empty(0);
  FrameStream nothing(&empty, nullptr, GetParam());
  for (int again = 0; again < 2; ++again) {
    EXPECT_FALSE(stream.Next().has_value());
    EXPECT_FALSE(nothing.Next().has_value());
  }
}

TEST_P(FrameStreamTest, PreparesFrames) {
  FakeSource source(20);
  static std::atomic<int> made;
  struct Twice {
    explicit Twice(const PreparedFrame& frame)
        : value(2 * frame.gray.at<uint8_t>(0, 0)) {
      ++made;
    }
    int value;
  };
  made = 0;
  FrameStream stream(
      &source, [](const PreparedFrame& frame) { frame.Derived<Twice>(); },
      GetParam());
  for (int i = 0; i < 20; ++i) {
    const StreamedFrame next = stream.Next().value();
    EXPECT_GE(made, i + 1);
    EXPECT_EQ(next.frame.Derived<Twice>().value, 2 * i);
  }
  EXPECT_EQ(made, 20);
}

TEST_P(FrameStreamTest, RethrowsForExactlyTheFramesThatFail) {
  FakeSource source(12);
  source.unreadable = {0, 3, 4, 11};
  source.missing = {1, 7};
  FrameStream stream(&source, nullptr, GetParam());
  for (int i = 0; i < 12; ++i) {
    if (source.unreadable.count(i) > 0) {
      ExpectInputError([&stream] { stream.Next(); },
                       {"image " + std::to_string(i) + " is broken"});
    } else if (source.missing.count(i) > 0) {
      ExpectInputError([&stream] { stream.Next(); }, {"the cable is loose"});
    } else {
      ExpectFrame(&stream, i);
    }
  }
}

TEST_P(FrameStreamTest, LeavesOutDamagedFrames) {
  FakeSource source(100);
  source.unreadable = {0, 3, 99};
  FrameStream stream(&source, nullptr, GetParam(), 0.05);
  for (int i = 0; i < 100; ++i) {
    if (source.unreadable.count(i) == 0) ExpectFrame(&stream, i);
  }
  EXPECT_FALSE(stream.Next().has_value());
  EXPECT_EQ(stream.stopped(), "");
  ASSERT_EQ(stream.damaged().size(), 3u);
  EXPECT_EQ(stream.damaged()[1], "image 3 is broken");
}

TEST_P(FrameStreamTest, EndsWhereTooManyAreDamaged) {
  FakeSource source(100);
  source.unreadable = {3, 30, 59, 60, 70};
  FrameStream stream(&source, nullptr, GetParam(), 0.05);
  int frames = 0;
  while (stream.Next().has_value()) ++frames;
  EXPECT_EQ(frames, 57) << "3 of 60 are too many";
  EXPECT_EQ(stream.stopped(),
            "3 of 60 frames cannot be read, the last: image 59 is broken; with "
            "max_damaged 1 (--max_damaged=1) it goes on");
}

TEST_P(FrameStreamTest, EndsWhereTheSourceFails) {
  FakeSource source(6);
  source.missing = {3};
  FrameStream stream(&source, nullptr, GetParam(), 0.05);
  for (int i = 0; i < 3; ++i) ExpectFrame(&stream, i);
  EXPECT_FALSE(stream.Next().has_value());
  EXPECT_EQ(stream.stopped(), "the cable is loose");
}

TEST_P(FrameStreamTest, WithoutAnyFrameTheFirstErrorIsThrown) {
  FakeSource damaged(2);
  damaged.unreadable = {0, 1};
  FrameStream stream(&damaged, nullptr, GetParam(), 0.05);
  EXPECT_THAT([&stream] { stream.Next(); },
              testing::ThrowsMessage<InputError>("image 0 is broken"));
  // More frames than these are there, so it could go on.
  FakeSource many(100);
  many.unreadable = {0, 1, 2, 3, 4};
  FrameStream few(&many, nullptr, GetParam(), 0.05);
  ExpectInputError([&few] { few.Next(); },
                   {"image 0 is broken; with max_damaged 1"});
  FakeSource missing(2);
  missing.missing = {0};
  FrameStream none(&missing, nullptr, GetParam(), 0.05);
  ExpectInputError([&none] { none.Next(); }, {"the cable is loose"});
}

// Like a full disk: this is not damage of the frame.
TEST_P(FrameStreamTest, WhatPreparingThrowsIsNoDamage) {
  FakeSource source(4);
  FrameStream stream(
      &source,
      [](const PreparedFrame& frame) {
        if (frame.index == 1) throw InputError("the disk is full");
      },
      GetParam(), 0.5);
  ExpectFrame(&stream, 0);
  ExpectInputError([&stream] { stream.Next(); }, {"the disk is full"});
}

TEST_P(FrameStreamTest, SaysHowLongAFrameTook) {
  FakeSource source(4);
  source.on_read = [](int index) {
    if (index == 2) std::this_thread::sleep_for(kPause);
  };
  FrameStream stream(&source, nullptr, GetParam());
  for (int i = 0; i < 4; ++i) {
    const double decode_ms = stream.Next().value().decode_ms;
    EXPECT_GE(decode_ms, i == 2 ? kPause.count() : 0.0);
  }
}

TEST_P(FrameStreamTest, CanBeGivenUpAtAnyTime) {
  for (int taken = 0; taken < 4; ++taken) {
    FakeSource source(100);
    source.unreadable = {5};
    source.on_read = [](int) { std::this_thread::sleep_for(milliseconds(1)); };
    {
      FrameStream stream(&source, nullptr, GetParam());
      for (int i = 0; i < taken; ++i) ExpectFrame(&stream, i);
    }
    const int reads = source.reads;
    EXPECT_LT(reads, 100);
    std::this_thread::sleep_for(kPause);
    EXPECT_EQ(source.reads, reads) << "somebody goes on reading";
  }
}

TEST_P(FrameStreamTest, StaysAFewFramesAhead) {
  const int threads = GetParam();
  const int most = threads == 1 ? 0 : threads + 8;
  FakeSource source(100);
  FrameStream stream(&source, nullptr, threads);
  for (int taken = 0; taken < 5; ++taken) {
    ASSERT_TRUE(WaitFor([&] { return source.reads == taken + most; }));
    std::this_thread::sleep_for(kPause);
    EXPECT_EQ(source.reads, taken + most);
    ExpectFrame(&stream, taken);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, FrameStreamTest, testing::Values(1, 2, 5));

TEST(FrameStreamThreadsTest, OneThreadIsTheCallingOne) {
  FakeSource source(3);
  const std::thread::id caller = std::this_thread::get_id();
  source.on_read = [caller](int) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
  };
  FrameStream stream(&source, nullptr, 1);
  for (int i = 0; i < 3; ++i) ExpectFrame(&stream, i);
}

#ifdef __linux__
TEST(FrameStreamThreadsTest, ReadingAheadGivesWayToTheCallingThread) {
  constexpr int kUnknown = -100;
  constexpr int kSteps = 5, kLowest = 19;
  FakeSource source(1);
  std::atomic<int> priority = kUnknown;
  source.on_read = [&](int) { priority = getpriority(PRIO_PROCESS, 0); };
  FrameStream stream(&source, nullptr, 2);
  ASSERT_TRUE(WaitFor([&] { return priority != kUnknown; }));
  EXPECT_EQ(priority, std::min(getpriority(PRIO_PROCESS, 0) + kSteps, kLowest));
}
#endif

// While a camera's next frame is not there yet, the previous one is returned.
TEST(FrameStreamThreadsTest, GivesAFrameWhileTheSourceWaitsForTheNext) {
  FakeSource source(2);
  std::promise<void> taken;
  std::future<void> is_taken = taken.get_future();
  std::thread::id caller = std::this_thread::get_id();
  source.on_ask = [&](int index) {
    if (index == 1 && std::this_thread::get_id() != caller) {
      EXPECT_EQ(is_taken.wait_for(kPatience), std::future_status::ready);
    }
  };
  FrameStream stream(&source, nullptr, 2);
  ExpectFrame(&stream, 0);
  taken.set_value();
  ExpectFrame(&stream, 1);
}

// Two reads that wait for each other need two reading threads.
TEST(FrameStreamThreadsTest, TheCallingThreadReadsInsteadOfSleeping) {
  FakeSource source(2);
  std::promise<void> begun[2];
  std::future<void> has_begun[2] = {begun[0].get_future(),
                                    begun[1].get_future()};
  source.on_read = [&](int index) {
    begun[index].set_value();
    EXPECT_EQ(has_begun[1 - index].wait_for(kPatience),
              std::future_status::ready)
        << "nobody reads the other frame";
  };
  FrameStream stream(&source, nullptr, 2);
  for (int i = 0; i < 2; ++i) ExpectFrame(&stream, i);
}

}  // namespace
}  // namespace rgbd_pose
