#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "apps/pipeline/odometry_run.h"
#include "apps/results/run_tracking.h"
#include "apps/view/view_server.h"
#include "apps/view/view_state.h"

namespace rgbd_pose {

// A page that shows a run as it goes on, if --view asks for it.
class LiveView {
 public:
  // Prints the page's address on stderr. `map` is that of the run; null: it has
  // none. Both must outlive it. Throws InputError for flags that make no sense.
  LiveView(const std::string& dataset, const Camera& camera,
           const SequenceRun& run, const Slam* map);

  // After the run has tracked a frame: shows it, and waits where --view_speed
  // or a button asks for it. Returns why the run is to end, or nothing.
  std::string Add(const Frame& frame, const StopSignal& signal);

  // After the last: `results` says where they are.
  void Finish(const std::string& results);

 private:
  using Clock = std::chrono::steady_clock;

  ViewFrame Describe(const TrackedFrame& tracked) const;
  void AddKeyframe(const TrackedFrame& tracked, ViewNews* news);
  void AddMap(bool has_moved, ViewNews* news);
  ViewImages Show(const Frame& frame) const;
  void KeepPace(double timestamp, const StopSignal& signal);
  void WaitWhilePaused(const StopSignal& signal);

  const Camera camera_;
  const SequenceRun& run_;
  const Slam* map_;
  ViewState state_;
  std::unique_ptr<ViewServer> server_;  // null: not asked for

  std::map<int, Rigid3d> keyframes_;  // of a run without a map
  size_t links_ = 0;                  // of the map, that were shown
  Clock::time_point due_ = {};        // when the last frame was to be shown
  double last_timestamp_ = 0.0;
};

}  // namespace rgbd_pose
