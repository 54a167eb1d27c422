#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "apps/pipeline/odometry_run.h"
#include "apps/results/run_output.h"
#include "apps/view/view_server.h"
#include "apps/view/view_state.h"

namespace rgbd_pose {

// A page that shows a run while it is running, if requested by --view.
class LiveView {
 public:
  // Prints the address of the page on stderr. `run` must outlive this object.
  // Throws InputError for invalid flags.
  LiveView(const std::string& dataset, const Camera& camera,
           const SequenceRun& run);

  // Call after a frame was tracked. Shows the frame and waits if --view_speed
  // or a button requests it. Returns why the run is to end, or an empty string.
  std::string Add(const Frame& frame, const StopSignal& signal);

  // Call after the last frame. `results` is the location of the results.
  void Finish(const std::string& results);

 private:
  using Clock = std::chrono::steady_clock;

  ViewFrame Describe(const TrackedFrame& tracked) const;
  void AddKeyframe(const TrackedFrame& tracked, ViewNews* news);
  void AddMap(bool has_moved, ViewNews* news);
  ViewImages Show(Frame frame) const;
  void KeepPace(const StopSignal& signal);
  void WaitWhilePaused(const StopSignal& signal);

  const Camera camera_;
  const SequenceRun& run_;
  const Slam* const map_;  // null: the run has none
  ViewState state_;
  std::unique_ptr<ViewServer> server_;  // null: not requested

  std::map<int, Rigid3d> keyframes_;  // for a run without a map
  size_t links_ = 0;                  // number of map links shown so far
  Clock::time_point due_ = {};        // when the last frame had to be shown
};

}  // namespace rgbd_pose
