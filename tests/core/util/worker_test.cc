#include "core/util/worker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace rgbd_pose {
namespace {

TEST(WorkerTest, DoesItsTasksInTheirOrder) {
  Worker worker;
  std::vector<int> done;
  std::future<void> last;
  for (int i = 0; i < 100; ++i) {
    last = worker.Submit([&done, i] { done.push_back(i); });
  }
  last.get();
  ASSERT_EQ(done.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(done[i], i);
}

TEST(WorkerTest, ReturnsAndThrowsByTheFutureAndGoesOn) {
  Worker worker;
  auto bad = worker.Submit([]() -> int { throw std::runtime_error("no"); });
  auto good = worker.Submit([] { return 7; });
  EXPECT_THROW(bad.get(), std::runtime_error);
  EXPECT_EQ(good.get(), 7);
}

TEST(WorkerTest, LeavesWhatItHasNotBegunWhenItEnds) {
  constexpr int kTasks = 1000;  // they take five seconds
  int begun = 0, done = 0;
  std::future<void> last;
  {
    Worker worker;
    for (int i = 0; i < kTasks; ++i) {
      last = worker.Submit([&] {
        ++begun;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        ++done;
      });
    }
  }
  EXPECT_LT(begun, kTasks);
  EXPECT_EQ(done, begun);
  EXPECT_THROW(last.get(), std::future_error);  // broken promise
}

#ifdef __linux__
TEST(WorkerTest, GivesWayToTheThreadThatGivesItWork) {
  const int here = getpriority(PRIO_PROCESS, 0);
  Worker worker;
  const int there =
      worker.Submit([] { return getpriority(PRIO_PROCESS, 0); }).get();
  EXPECT_EQ(there, std::min(here + 5, 19));
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), here);
}
#endif

}  // namespace
}  // namespace rgbd_pose
