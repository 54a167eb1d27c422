#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/view/view_server.h"
#include "apps/view/view_state.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/sequence_run.h"

namespace rgbd_pose {

// Settings of the live page, named like the flags of the programs.
struct ViewSettings {
  bool view = false;        // whether there is a page
  int view_port = 0;        // 0: any free port
  double view_speed = 0.0;  // at most, as a multiple of real time; 0: no limit
};

std::vector<Setting> SettingTable(ViewSettings* settings);

// A page that shows a run while it is running, if requested.
class LiveView {
 public:
  // Shows the frames that the run has tracked so far. `run` must outlive this
  // object. Throws InputError for invalid settings.
  LiveView(const std::string& title, const ViewSettings& settings,
           const Camera& camera, const SequenceRun& run);

  // The address of the page, if there is one.
  bool is_open() const { return server_ != nullptr; }
  const std::string& address() const { return server_->address(); }

  // Whether the stop button was pressed.
  bool is_stopped() const { return state_.is_stopped(); }

  // Shows a frame that was tracked and waits if the speed or a button requests
  // it, until `is_interrupted`. Returns why the run is to end, or empty.
  std::string Add(const Frame& frame,
                  const std::function<bool()>& is_interrupted);

  // Ends the page after the last frame. `results`: their location, or empty.
  void Finish(const std::string& results);

 private:
  using Clock = std::chrono::steady_clock;

  void AddFrame(size_t index, const cv::Mat& color, ViewNews* news);
  void AddKeyframe(const TrackedFrame& tracked, const cv::Mat& color,
                   ViewNews* news);
  void AddMap(bool has_moved, ViewNews* news);
  ViewImages Show(Frame frame) const;
  void KeepPace(const std::function<bool()>& is_interrupted);
  void WaitWhilePaused(const std::function<bool()>& is_interrupted);

  const double speed_;
  const Camera camera_;
  const SequenceRun& run_;
  const Slam* const map_;  // null: the run has none
  ViewState state_;
  std::unique_ptr<ViewServer> server_;  // null: not requested

  std::map<int, Rigid3d> keyframes_;  // for a run without a map
  cv::Mat previous_color_;            // of the last frame
  size_t links_ = 0;                  // number of map links shown so far
  Clock::time_point due_ = {};        // when the last frame had to be shown
};

}  // namespace rgbd_pose
