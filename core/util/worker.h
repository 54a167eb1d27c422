#pragma once

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace rgbd_pose {

// Lowers the priority of the calling thread and of those it starts, for work
// that nobody waits for yet. Only Linux has priorities of threads.
inline void LowerThreadPriority() {
#ifdef __linux__
  constexpr int kSteps = 5;  // a third of the time of an equal thread
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kSteps);
#endif
}

// A thread of low priority that executes tasks in the order of submission.
class Worker {
 public:
  Worker() : thread_([this] { Work(); }) {}

  // Finishes the running task and discards the others.
  ~Worker() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_over_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // The future returns the result of the task or throws its exception.
  template <typename Task>
  auto Submit(Task task) -> std::future<decltype(task())> {
    std::packaged_task<decltype(task())()> packaged(std::move(task));
    auto result = packaged.get_future();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      tasks_.emplace_back(std::move(packaged));
    }
    changed_.notify_one();
    return result;
  }

 private:
  void Work() {
    LowerThreadPriority();
    while (true) {
      std::packaged_task<void()> task;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [this] { return is_over_ || !tasks_.empty(); });
        if (is_over_) return;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      task();
    }
  }

  std::mutex mutex_;  // guards all members below
  std::condition_variable changed_;
  std::deque<std::packaged_task<void()>> tasks_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace rgbd_pose
