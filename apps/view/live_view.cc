#include "apps/view/live_view.h"

#include <algorithm>
#include <utility>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using std::chrono::milliseconds;

// Interval for checking signals while waiting.
constexpr milliseconds kSlice(50);

// After this time without an open page, a paused run continues.
constexpr std::chrono::seconds kAlone(10);

}  // namespace

std::vector<Setting> SettingTable(ViewSettings* settings) {
  constexpr std::string_view kGroup = "View";
  return {
      {"view", kGroup,
       "show the run live in a browser on this machine: path, map, images and "
       "figures; prints the address of the page",
       &settings->view},
      {"view_port", kGroup, "port of the live page; 0: any free port",
       &settings->view_port},
      {"view_speed", kGroup,
       "with --view: maximum playback speed as a multiple of the recording's "
       "own rate; 0: no limit",
       &settings->view_speed},
  };
}

LiveView::LiveView(const std::string& title, const ViewSettings& settings,
                   const Camera& camera, const SequenceRun& run)
    : speed_(settings.view_speed),
      camera_(camera),
      run_(run),
      map_(run.slam()) {
  const int port = settings.view_port;
  if (!(speed_ >= 0.0)) throw InputError("view_speed must not be negative");
  if (port < 0 || port > 65535) {
    throw InputError("view_port must be 0 (any free port) to 65535");
  }
  if (!settings.view) {
    if (speed_ > 0.0 || port > 0) {
      throw InputError("view_speed and view_port need view");
    }
    return;
  }
  server_ = std::make_unique<ViewServer>(title, port, &state_);
  ViewNews news;
  for (size_t i = 0; i < run.frames().size(); ++i) AddFrame(i, {}, &news);
  AddMap(/*has_moved=*/true, &news);
  state_.Add(std::move(news));
}

std::string LiveView::Add(const Frame& frame,
                          const std::function<bool()>& is_interrupted) {
  if (server_ == nullptr) return "";
  ViewNews news;
  AddFrame(run_.frames().size() - 1, frame.color, &news);
  AddMap(!news.keyframes.empty(), &news);
  if (state_.readers() > 0) news.images = Show(frame);
  state_.Add(std::move(news));
  KeepPace(is_interrupted);
  WaitWhilePaused(is_interrupted);
  return is_stopped() ? "stop button of the live page" : "";
}

void LiveView::Finish(const std::string& results) {
  if (server_ == nullptr) return;
  ViewNews news;
  AddMap(/*has_moved=*/true, &news);
  state_.Add(std::move(news));
  state_.Finish(results);
  server_.reset();
}

void LiveView::AddFrame(size_t index, const cv::Mat& color, ViewNews* news) {
  const TrackedFrame& tracked = run_.frames()[index];
  if (tracked.previous_is_reference) {
    AddKeyframe(run_.frames()[index - 1], previous_color_, news);
  }
  if (tracked.is_reference) AddKeyframe(tracked, color, news);
  previous_color_ = color;
  ViewFrame shown = {tracked, std::nullopt, {}};
  shown.edges = std::vector<RelativePose>();  // frees them
  if (tracked.status != TrackingStatus::kLost) {
    int keyframe = tracked.index;
    if (!tracked.is_reference && tracked.reference != -1) {
      keyframe = tracked.reference;
      shown.keyframe_from_cam = tracked.cur_from_reference.Inverse();
    }
    shown.keyframe = map_ == nullptr ? keyframe : map_->MapId(keyframe);
  }
  news->frames.push_back(std::move(shown));
}

void LiveView::AddKeyframe(const TrackedFrame& tracked, const cv::Mat& color,
                           ViewNews* news) {
  if (map_ == nullptr) keyframes_[tracked.index] = tracked.world_from_cam;
  const OdometryKeyframe* keyframe =
      run_.odometry().FindKeyframe(tracked.index);
  if (keyframe == nullptr) return;
  news->keyframes.push_back(
      {map_ == nullptr ? tracked.index : map_->MapId(tracked.index),
       SamplePoints(keyframe->frame, color, camera_)});
}

// Adds the keyframe poses, if they have changed, and the new links.
void LiveView::AddMap(bool has_moved, ViewNews* news) {
  if (map_ == nullptr) {
    if (has_moved) news->poses = keyframes_;
    return;
  }
  const std::vector<MapEdge>& links = map_->links();
  if (links.size() > links_) has_moved = true;
  if (has_moved) news->poses = map_->keyframe_poses();
  news->links.assign(links.begin() + links_, links.end());
  links_ = links.size();
}

ViewImages LiveView::Show(Frame frame) const {
  ViewImages images = {frame.gray, frame.depth, frame.depth_scale, {}};
  if (run_.frames().back().reference == -1) return images;
  const Odometry& odometry = run_.odometry();
  frame.twist = odometry.last_twist();
  images.moves = MatchesInImage(frame, camera_, odometry.last_matches().matches,
                                odometry.last_estimate().weights);
  return images;
}

// A late frame delays all later ones, because lost time is not caught up.
void LiveView::KeepPace(const std::function<bool()>& is_interrupted) {
  if (speed_ <= 0.0) return;
  const std::vector<TrackedFrame>& frames = run_.frames();
  if (frames.size() > 1) {
    const std::chrono::duration<double> wait(
        (frames.back().timestamp - frames[frames.size() - 2].timestamp) /
        speed_);
    due_ += std::chrono::duration_cast<Clock::duration>(wait);
  }
  due_ = std::max(due_, Clock::now());
  while (Clock::now() < due_ && !is_interrupted() && !state_.is_stopped() &&
         !state_.is_paused()) {
    state_.WaitForControl(std::min(
        kSlice, std::chrono::duration_cast<milliseconds>(due_ - Clock::now()) +
                    milliseconds(1)));
  }
}

void LiveView::WaitWhilePaused(const std::function<bool()>& is_interrupted) {
  Clock::time_point last_seen = Clock::now();
  while (state_.is_paused() && !state_.is_stopped() && !is_interrupted()) {
    if (state_.readers() > 0) last_seen = Clock::now();
    if (Clock::now() - last_seen > kAlone) state_.Pause(false);
    state_.WaitForControl(kSlice);
  }
}

}  // namespace rgbd_pose
