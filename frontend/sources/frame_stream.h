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

#include "core/util/input_error.h"
#include "frontend/frame/prepared_frame.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A frame, and how long reading and preparing it took, in whichever thread.
struct StreamedFrame {
  PreparedFrame frame;
  double decode_ms = 0.0;  // to read and to prepare it
};

// The frames of a source in order, read and prepared ahead by several threads.
// The thread that calls Next is one of them: where its frame is not ready yet,
// it reads one itself instead of sleeping, so that all threads are always busy.
// The frames are the same whatever the number of threads.
class FrameStream {
 public:
  // Works on a frame in the thread that has read it (Frontend::Prepare, say).
  using Prepare = std::function<void(const PreparedFrame& frame)>;

  // `threads` >= 1 counts the calling one: 1 reads each frame when it is asked
  // for. `prepare` may be empty. The source must outlive the stream, and nobody
  // else may ask it for frames. `max_damaged`: the share of frames that are
  // left out if they cannot be read; nothing: each is an error.
  FrameStream(FrameSource* source, Prepare prepare, int threads,
              std::optional<double> max_damaged = std::nullopt);

  // Gives up the frames that were not asked for; waits for those being read.
  ~FrameStream();
  FrameStream(const FrameStream&) = delete;
  FrameStream& operator=(const FrameStream&) = delete;

  // The next frame; nothing after the last one. Always to be called from the
  // same thread. Rethrows what reading this frame threw; the one after can be
  // asked for nevertheless. With `max_damaged` only what preparing it threw: a
  // frame that cannot be read is left out, and where the source fails or too
  // many are damaged (three, at least) the frames end there. If there was none
  // at all, it throws what the first one did.
  std::optional<StreamedFrame> Next();

  // The frames left out so far: which image of each, and why.
  const std::vector<std::string>& damaged() const { return damaged_; }

  // Why the frames ended before the last one; empty: they did not.
  const std::string& stopped() const { return stopped_; }

 private:
  struct Result {
    StreamedFrame frame;
    std::exception_ptr error;
    enum { kSource, kRead, kPrepare } failed = kSource;  // what threw it
  };
  using Lock = std::unique_lock<std::mutex>;

  // Of the next frame; nothing after the last one.
  std::optional<Result> Take();
  // Leaves the frame out or ends here.
  void LeaveOut(const Result& result, const InputError& error);

  // Whether a frame may be begun: not more than a few ahead, for the memory.
  bool CanBegin() const;
  // Begins the next frame and sees it through, with the lock given up
  // meanwhile.
  void ReadOne(Lock* lock);
  void Work();

  FrameSource* const source_;
  const Prepare prepare_;
  const int max_ahead_;
  const std::optional<double> max_damaged_;
  const size_t num_expected_;  // as far as the source knows
  size_t num_good_ = 0;        // frames given
  std::vector<std::string> damaged_;
  std::string stopped_;
  std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  bool is_asking_ = false;       // somebody is asking the source
  std::map<int, Result> ready_;  // by frame
  int num_begun_ = 0;
  int num_taken_ = 0;
  int size_ = std::numeric_limits<int>::max();  // until the source has ended
  bool stop_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace rgbd_pose
