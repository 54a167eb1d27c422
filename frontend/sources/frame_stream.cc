#include "frontend/sources/frame_stream.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "core/util/format.h"
#include "core/util/stage_timer.h"
#include "core/util/worker.h"

namespace rgbd_pose {
namespace {

// Frames that may be ready in addition to those being read: enough for a few
// frames that take long to track. A frame of 640 x 480 with pyramid is 1.5 MB.
constexpr int kMaxReady = 8;

// Below these numbers, a share of damaged frames says little.
constexpr size_t kLeastFrames = 60;
constexpr size_t kLeastDamaged = 3;

}  // namespace

FrameStream::FrameStream(FrameSource* source, Prepare prepare, int threads,
                         std::optional<double> max_damaged)
    : source_(source),
      prepare_(std::move(prepare)),
      max_ahead_(threads + kMaxReady),
      max_damaged_(max_damaged),
      num_expected_(max_damaged ? source->timestamps().size() : 0) {
  try {
    for (int i = 1; i < threads; ++i) {
      workers_.emplace_back(&FrameStream::Work, this);
    }
  } catch (const std::system_error&) {  // fewer threads will do
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
  while (stopped_.empty()) {
    std::optional<Result> result = Take();
    if (!result.has_value()) break;
    if (result->error == nullptr) {
      ++num_good_;
      std::vector<ImuSample>& imu = result->frame.imu;
      imu.insert(imu.begin(), left_out_imu_.begin(), left_out_imu_.end());
      left_out_imu_.clear();
      return std::move(result->frame);
    }
    try {
      std::rethrow_exception(result->error);
    } catch (const InputError& error) {
      if (!max_damaged_.has_value() || result->failed == Result::kPrepare)
        throw;
      LeaveOut(*std::move(result), error);
    }
  }
  if (num_good_ > 0 || damaged_.empty()) return std::nullopt;
  // At the end of the source nothing is left to go on with.
  throw InputError(damaged_.front() + (stopped_.empty() ? "" : Hint()));
}

std::string FrameStream::Hint() const {
  return *max_damaged_ < 1.0
             ? "; with max_damaged 1 (--max_damaged=1) it goes on"
             : "";
}

void FrameStream::End() {
  {
    const Lock lock(mutex_);
    size_ = std::min(size_, num_begun_);
  }
  changed_.notify_all();
}

void FrameStream::LeaveOut(Result result, const InputError& error) {
  if (result.failed == Result::kSource) {
    if (num_good_ == 0 && damaged_.empty()) throw error;
    stopped_ = error.what();
    return;
  }
  damaged_.emplace_back(error.what());
  left_out_imu_.insert(left_out_imu_.end(), result.frame.imu.begin(),
                       result.frame.imu.end());
  const size_t seen =
      std::max({num_good_ + damaged_.size(), num_expected_, kLeastFrames});
  const size_t least = *max_damaged_ > 0.0 ? kLeastDamaged : 1;
  if (damaged_.size() < std::max<double>(least, *max_damaged_ * seen)) return;
  stopped_ =
      Format("%zu of %zu frames cannot be read, the last: ", damaged_.size(),
             num_good_ + damaged_.size()) +
      error.what() + Hint();
}

std::optional<FrameStream::Result> FrameStream::Take() {
  Lock lock(mutex_);
  // Frames are started in order: if this one is not ready, either another
  // thread is reading it or it is the next to start.
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
  return result;
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
  Result result;
  try {
    next = source_->Next();
  } catch (...) {  // counts as the error of this frame
    result.error = std::current_exception();
  }
  lock->lock();
  is_asking_ = false;
  changed_.notify_all();
  if (!next.has_value()) {
    if (result.error == nullptr) size_ = index;
    if (result.error != nullptr) ready_.emplace(index, std::move(result));
    return;
  }

  lock->unlock();
  result.frame.imu = std::move(next->imu);
  result.failed = Result::kRead;
  try {
    const StageTimer timer(&result.frame.decode_ms);
    result.frame.frame = PreparedFrame(next->read());
    result.failed = Result::kPrepare;
    if (prepare_) prepare_(result.frame.frame);
  } catch (...) {
    result.error = std::current_exception();
  }
  lock->lock();
  ready_.emplace(index, std::move(result));
  changed_.notify_all();
}

void FrameStream::Work() {
  // The tracking thread goes first: it reads frames itself if they run short.
  LowerThreadPriority();
  Lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || CanBegin(); });
    if (stop_) return;
    ReadOne(&lock);
  }
}

}  // namespace rgbd_pose
