#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/inertial/imu_sample.h"
#include "core/util/input_error.h"
#include "frontend/frame/prepared_frame.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A frame, read and prepared.
struct StreamedFrame {
  PreparedFrame frame;
  double decode_ms = 0.0;  // duration of both, in whichever thread

  // As RgbdFrame::imu; with those of frames that were left out before it.
  std::vector<ImuSample> imu = {};
};

// The frames of a source in order, read and prepared ahead by several threads.
// The thread that calls Next is one of them: if its frame is not ready, it
// reads one itself. The frames do not depend on the number of threads.
class FrameStream {
 public:
  // Processes a frame in the thread that has read it (e.g. Frontend::Prepare).
  using Prepare = std::function<void(const PreparedFrame& frame)>;

  // `threads` >= 1 includes the calling one: with 1, each frame is read on
  // request. `prepare` may be empty. The source must outlive the stream and
  // must not be used otherwise. `max_damaged`: the share of unreadable frames
  // that may be left out; nothing: every unreadable frame is an error.
  FrameStream(FrameSource* source, Prepare prepare, int threads,
              std::optional<double> max_damaged = std::nullopt);

  // Discards the frames that were not requested; waits for those being read.
  ~FrameStream();

  // The next frame; nothing after the last one. Must always be called from the
  // same thread. Rethrows the error of reading this frame, after which the next
  // one can be requested. With `max_damaged` only errors of `prepare` are
  // rethrown: unreadable frames are left out, and the frames end where the
  // source fails or too many are damaged (at least three; one for a share of
  // 0). If no frame was read at all, throws the first error.
  std::optional<StreamedFrame> Next();

  // Asks the source for no further frame; those that were begun still come.
  void End();

  // The frames left out so far: which image is damaged, and why.
  const std::vector<std::string>& damaged() const { return damaged_; }

  // Why the frames ended early; empty if they did not.
  const std::string& stopped() const { return stopped_; }

 private:
  struct Result {
    StreamedFrame frame;
    std::exception_ptr error;
    enum { kSource, kRead, kPrepare } failed = kSource;  // what threw it
  };
  using Lock = std::unique_lock<std::mutex>;

  // The result for the next frame; nothing after the last one.
  std::optional<Result> Take();
  // How to go on in spite of damaged frames; empty if nothing more is allowed.
  std::string Hint() const;
  // Leaves the frame out or ends the stream. The inertial samples are kept.
  void LeaveOut(Result result, const InputError& error);

  // Whether a frame may be started. Few are read ahead, to save memory.
  bool CanBegin() const;
  // Reads and prepares the next frame; the lock is released meanwhile.
  void ReadOne(Lock* lock);
  void Work();

  FrameSource* const source_;
  const Prepare prepare_;
  const int max_ahead_;
  const std::optional<double> max_damaged_;
  const size_t num_expected_;            // of the source; 0: not known
  size_t num_good_ = 0;                  // frames returned
  std::vector<ImuSample> left_out_imu_;  // since the last frame returned
  std::vector<std::string> damaged_;
  std::string stopped_;
  std::mutex mutex_;  // guards all members below
  std::condition_variable changed_;
  bool is_asking_ = false;       // a thread is in source_->Next()
  std::map<int, Result> ready_;  // by frame number
  int num_begun_ = 0;
  int num_taken_ = 0;
  int size_ = std::numeric_limits<int>::max();  // set when the source has ended
  bool stop_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace rgbd_pose
