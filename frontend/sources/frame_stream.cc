#include "frontend/sources/frame_stream.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace rgbd_pose {
namespace {

// How many frames may lie ready beyond those being read: enough for a few
// frames that take long to track. A frame of 640 x 480 with its pyramid is
// 1.5 MB.
constexpr int kMaxReady = 8;

}  // namespace

FrameStream::FrameStream(const Dataset& dataset,
                         std::function<void(Frame*)> prepare, int threads)
    : dataset_(dataset),
      prepare_(std::move(prepare)),
      max_ahead_(threads + kMaxReady) {
  const int num_workers = std::min(threads - 1, dataset.size());
  for (int i = 0; i < num_workers; ++i) {
    workers_.emplace_back(&FrameStream::Work, this);
  }
}

FrameStream::~FrameStream() {
  {
    const Lock lock(mutex_);
    stop_ = true;
  }
  may_begin_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

StreamedFrame FrameStream::Next() {
  Lock lock(mutex_);
  if (num_taken_ == dataset_.size()) {
    throw std::out_of_range("no frame is left in the stream");
  }
  // Frames are begun in order: if this one is not ready, it is being read by
  // another thread, or it is the next to begin.
  while (ready_.count(num_taken_) == 0) {
    if (CanBegin()) {
      ReadOne(&lock);
    } else {
      is_ready_.wait(lock);
    }
  }
  Result result = std::move(ready_.extract(num_taken_).mapped());
  ++num_taken_;
  lock.unlock();
  may_begin_.notify_one();
  if (result.error != nullptr) std::rethrow_exception(result.error);
  return std::move(result.frame);
}

bool FrameStream::CanBegin() const {
  return num_begun_ < std::min(dataset_.size(), num_taken_ + max_ahead_);
}

void FrameStream::ReadOne(Lock* lock) {
  const int index = num_begun_++;
  lock->unlock();
  Result result;
  const auto start = std::chrono::steady_clock::now();
  try {
    result.frame.frame = dataset_.Read(index);
    if (prepare_) prepare_(&result.frame.frame);
  } catch (...) {
    result.error = std::current_exception();
  }
  result.frame.decode_ms = std::chrono::duration<double, std::milli>(
                               std::chrono::steady_clock::now() - start)
                               .count();
  lock->lock();
  ready_.emplace(index, std::move(result));
  is_ready_.notify_one();
}

void FrameStream::Work() {
  Lock lock(mutex_);
  while (true) {
    may_begin_.wait(lock, [this] { return stop_ || CanBegin(); });
    if (stop_) return;
    ReadOne(&lock);
  }
}

}  // namespace rgbd_pose
