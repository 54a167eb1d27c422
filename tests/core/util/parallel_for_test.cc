#include "core/util/parallel_for.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace rgbd_pose {
namespace {

TEST(ParallelForTest, DoesEachTaskOnceOnTheThreadThatItsNumberGives) {
  constexpr int kTasks = 10, kThreads = 3;
  std::vector<int> calls(kTasks, 0);
  std::vector<std::thread::id> threads(kTasks);
  ParallelFor(kTasks, kThreads, [&](int i) {
    ++calls[i];
    threads[i] = std::this_thread::get_id();
  });
  EXPECT_EQ(calls, std::vector<int>(kTasks, 1));
  EXPECT_EQ(threads[0], std::this_thread::get_id());
  EXPECT_NE(threads[1], threads[0]);
  EXPECT_NE(threads[2], threads[1]);
  for (int i = kThreads; i < kTasks; ++i) {
    EXPECT_EQ(threads[i], threads[i - kThreads]) << i;
  }
}

TEST(ParallelForTest, ThrowsWhatATaskThrowsAfterTheOtherThreadsHaveEnded) {
  for (int bad = 0; bad < 4; ++bad) {
    std::set<int> done[4];
    const auto work = [&](int i) {
      if (i % 4 == bad) throw std::runtime_error("no");
      done[i % 4].insert(i);
    };
    EXPECT_THROW(ParallelFor(400, 4, work), std::runtime_error) << bad;
    for (int t = 0; t < 4; ++t) {
      // The calling thread stops at once, the others finish what they do.
      EXPECT_EQ(done[t].size(), t == bad ? 0u : 100u) << bad << ", " << t;
    }
  }
}

TEST(ParallelForTest, TakesAnyNumberOfTasksAndThreads) {
  for (const int tasks : {0, 1, 2, 7}) {
    for (const int threads : {1, 2, 3, 16}) {
      std::vector<int> calls(tasks, 0);
      ParallelFor(tasks, threads, [&](int i) { ++calls[i]; });
      EXPECT_EQ(calls, std::vector<int>(tasks, 1)) << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
