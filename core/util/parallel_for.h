#pragma once

#include <algorithm>
#include <future>
#include <vector>

namespace rgbd_pose {

// Calls f(i) for i = 0 .. n - 1 on `threads` threads, including the calling
// one, or on fewer if the system gives no more. The assignment of i to threads
// is fixed. Throws what f throws. Only worth it for tasks of milliseconds.
template <typename Function>
void ParallelFor(int n, int threads, const Function& f) {
  threads = std::min(threads, n);
  const auto run = [n, threads, &f](int first) {
    for (int i = first; i < n; i += threads) f(i);
  };
  std::vector<std::future<void>> others;
  for (int t = 1; t < threads; ++t) others.push_back(std::async(run, t));
  run(0);
  for (std::future<void>& other : others) other.get();
}

}  // namespace rgbd_pose
