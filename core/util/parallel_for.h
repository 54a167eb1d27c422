#pragma once

#include <algorithm>
#include <thread>
#include <vector>

namespace rgbd_pose {

// Calls f(i) for i = 0 .. n - 1 on `threads` threads, including the calling
// one. The assignment of i to threads is fixed; f must not throw. Only worth it
// for tasks of milliseconds.
template <typename Function>
void ParallelFor(int n, int threads, const Function& f) {
  threads = std::min(threads, n);
  const auto run = [n, threads, &f](int first) {
    for (int i = first; i < n; i += threads) f(i);
  };
  std::vector<std::thread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(run, t);
  run(0);
  for (std::thread& other : others) other.join();
}

}  // namespace rgbd_pose
