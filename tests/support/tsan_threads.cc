// Linked into every program of a build for the thread sanitizer. The sanitizer
// does not see how the library under OpenCV's parallel loops synchronises its
// threads, and would report races. With this file the loops run on threads that
// the sanitizer sees.

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/parallel/parallel_backend.hpp>
#include <thread>
#include <vector>

namespace rgbd_pose {
namespace {

thread_local int thread_index = 0;

class SeenThreads : public cv::parallel::ParallelForAPI {
 public:
  void parallel_for(int tasks, FN_parallel_for_body_cb_t body,
                    void* data) override {
    const int count = std::min(threads_, tasks);
    std::vector<std::thread> threads;
    for (int i = 0; i < count; ++i) {
      threads.emplace_back([=] {
        thread_index = i;
        body(i * tasks / count, (i + 1) * tasks / count, data);
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  int getThreadNum() const override { return thread_index; }
  int getNumThreads() const override { return threads_; }
  int setNumThreads(int threads) override {
    const int before = threads_;
    threads_ = threads > 0 ? threads : kThreads;
    return before;
  }
  const char* getName() const override { return "threads"; }

 private:
  static constexpr int kThreads = 2;
  int threads_ = kThreads;
};

const bool installed = [] {
  cv::parallel::setParallelForBackend(std::make_shared<SeenThreads>(), false);
  // The sanitizer also misses the initialisation of shared data in OpenCV's
  // first matrix expression. Here it happens before there are threads.
  const cv::Mat first = cv::Mat::zeros(1, 1, CV_8U);
  return !first.empty();
}();

}  // namespace
}  // namespace rgbd_pose
