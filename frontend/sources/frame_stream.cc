#include "frontend/sources/frame_stream.h"

#include <chrono>
#include <utility>

#include "core/util/give_way.h"

namespace rgbd_pose {
namespace {

// How many frames may lie ready beyond those being read: enough for a few
// frames that take long to track. A frame of 640 x 480 with its pyramid is
// 1.5 MB.
constexpr int kMaxReady = 8;

}  // namespace

FrameStream::FrameStream(FrameSource* source, Prepare prepare, int threads)
    : source_(source),
      prepare_(std::move(prepare)),
      max_ahead_(threads + kMaxReady) {
  for (int i = 1; i < threads; ++i) {
    workers_.emplace_back(&FrameStream::Work, this);
  }
}

FrameStream::~FrameStream() {
  {
    const Lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

std::optional<StreamedFrame> FrameStream::Next() {
  Lock lock(mutex_);
  // Frames are begun in order: if this one is not ready, it is being read by
  // another thread, or it is the next to begin.
  while (num_taken_ < size_ && ready_.count(num_taken_) == 0) {
    if (CanBegin()) {
      ReadOne(&lock);
    } else {
      changed_.wait(lock);
    }
  }
  if (num_taken_ == size_) return std::nullopt;
  Result result = std::move(ready_.extract(num_taken_).mapped());
  ++num_taken_;
  lock.unlock();
  changed_.notify_all();
  if (result.error != nullptr) std::rethrow_exception(result.error);
  return std::move(result.frame);
}

bool FrameStream::CanBegin() const {
  return !is_asking_ && num_begun_ < size_ &&
         num_begun_ < num_taken_ + max_ahead_;
}

void FrameStream::ReadOne(Lock* lock) {
  const int index = num_begun_++;
  is_asking_ = true;
  lock->unlock();
  std::optional<RgbdFrame> next;
  try {
    next = source_->Next();
  } catch (...) {  // is the error of this frame
    next = RgbdFrame{0.0, [error = std::current_exception()]() -> Frame {
                       std::rethrow_exception(error);
                     }};
  }
  lock->lock();
  is_asking_ = false;
  if (!next.has_value()) size_ = index;
  changed_.notify_all();
  if (!next.has_value()) return;

  lock->unlock();
  const auto start = std::chrono::steady_clock::now();
  Result result;
  try {
    const Frame frame = next->read();
    result.frame.frame =
        prepare_ ? prepare_(frame) : std::make_unique<PreparedFrame>(frame);
  } catch (...) {
    result.error = std::current_exception();
  }
  result.frame.decode_ms = std::chrono::duration<double, std::milli>(
                               std::chrono::steady_clock::now() - start)
                               .count();
  lock->lock();
  ready_.emplace(index, std::move(result));
  changed_.notify_all();
}

void FrameStream::Work() {
  // To the thread that tracks, which reads for itself where frames run short.
  GiveWay();
  Lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || CanBegin(); });
    if (stop_) return;
    ReadOne(&lock);
  }
}

}  // namespace rgbd_pose
