#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "apps/pipeline/odometry_run.h"
#include "apps/view/live_view.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A run for several threads. Calls wait for each other and therefore must not
// hold the GIL. Keeps the results of all frames.
class SharedRun {
 public:
  const RgbdCamera& camera() const { return camera_; }

  // The current poses of the frames that were not lost.
  Trajectory trajectory() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return run_.Path();
  }

  // Opens a page that shows the run, in place of an earlier one, and returns
  // its address. Throws InputError for invalid settings.
  std::string OpenView(const std::string& title, const ViewSettings& settings);
  // Ends the page; its last news remain in open browsers.
  void CloseView();
  // Whether the stop button of the page was pressed.
  bool IsStopped();

 protected:
  SharedRun(const RgbdCamera& camera, SequenceRun run)
      : camera_(camera), run_(std::move(run)) {}

  // Tracks the next frame. If time does not increase (see StampFrame), throws
  // InputError and changes nothing. Call with mutex_ locked.
  void Add(Frame frame, std::optional<double> timestamp, const Rigid3d* guess);

  const RgbdCamera camera_;
  std::mutex mutex_;
  SequenceRun run_;
  std::unique_ptr<LiveView> view_;  // null: no page
};

}  // namespace rgbd_pose
