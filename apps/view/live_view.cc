#include "apps/view/live_view.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/util/input_error.h"

DEFINE_bool(view, false,
            "show the run live in a browser on this machine: path, map, images "
            "and figures; prints the address of the page");
DEFINE_int32(view_port, 0, "port of the live page; 0: any free port");
DEFINE_double(view_speed, 0.0,
              "with --view: maximum playback speed as a multiple of the "
              "recording's own rate; 0: no limit");

namespace rgbd_pose {
namespace {

using std::chrono::milliseconds;

// Interval for checking signals while waiting.
constexpr milliseconds kSlice(50);

// After this time without an open page, a paused run continues.
constexpr std::chrono::seconds kAlone(10);

}  // namespace

LiveView::LiveView(const std::string& dataset, const Camera& camera,
                   const SequenceRun& run)
    : camera_(camera), run_(run), map_(run.slam()) {
  if (!(FLAGS_view_speed >= 0.0)) {
    throw InputError("--view_speed must not be negative");
  }
  if (FLAGS_view_port < 0 || FLAGS_view_port > 65535) {
    throw InputError("--view_port must be 0 (any free port) to 65535");
  }
  if (!FLAGS_view) {
    if (FLAGS_view_speed > 0.0 || FLAGS_view_port > 0) {
      throw InputError("--view_speed and --view_port need --view");
    }
    return;
  }
  server_ = std::make_unique<ViewServer>(dataset, FLAGS_view_port, &state_);
  std::fprintf(stderr, "view on     %s\n", server_->address().c_str());
}

std::string LiveView::Add(const Frame& frame, const StopSignal& signal) {
  if (server_ == nullptr) return "";
  const std::vector<TrackedFrame>& frames = run_.frames();
  const TrackedFrame& tracked = frames.back();
  ViewNews news;
  if (tracked.previous_is_reference) {
    AddKeyframe(frames[frames.size() - 2], &news);
  }
  if (tracked.is_reference) AddKeyframe(tracked, &news);
  news.frames.push_back(Describe(tracked));
  AddMap(!news.keyframes.empty(), &news);
  if (state_.readers() > 0) news.images = Show(frame);
  state_.Add(std::move(news));
  KeepPace(signal);
  WaitWhilePaused(signal);
  return state_.is_stopped() ? "stop button of the live page" : "";
}

void LiveView::Finish(const std::string& results) {
  if (server_ == nullptr) return;
  ViewNews news;
  AddMap(/*has_moved=*/true, &news);
  state_.Add(std::move(news));
  state_.Finish(results);
  server_.reset();
}

ViewFrame LiveView::Describe(const TrackedFrame& tracked) const {
  ViewFrame shown = {tracked, std::nullopt, {}};
  shown.edges = std::vector<RelativePose>();  // frees them
  if (tracked.status == TrackingStatus::kLost) return shown;
  int keyframe = tracked.index;
  if (!tracked.is_reference && tracked.reference != -1) {
    keyframe = tracked.reference;
    shown.keyframe_from_cam = tracked.cur_from_reference.Inverse();
  }
  shown.keyframe = map_ == nullptr ? keyframe : map_->MapId(keyframe);
  return shown;
}

void LiveView::AddKeyframe(const TrackedFrame& tracked, ViewNews* news) {
  if (map_ == nullptr) keyframes_[tracked.index] = tracked.world_from_cam;
  const OdometryKeyframe* keyframe =
      run_.odometry().FindKeyframe(tracked.index);
  if (keyframe == nullptr) return;
  news->keyframes.push_back(
      {map_ == nullptr ? tracked.index : map_->MapId(tracked.index),
       SamplePoints(keyframe->frame, camera_)});
}

// Adds the keyframe poses, if they have changed, and the new links.
void LiveView::AddMap(bool has_moved, ViewNews* news) {
  if (map_ == nullptr) {
    if (has_moved) news->poses = keyframes_;
    return;
  }
  const std::vector<MapLink>& links = map_->links();
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

// A late frame delays all later ones: the lost time is not caught up.
void LiveView::KeepPace(const StopSignal& signal) {
  if (FLAGS_view_speed <= 0.0) return;
  const std::vector<TrackedFrame>& frames = run_.frames();
  if (frames.size() > 1) {
    const std::chrono::duration<double> wait(
        (frames.back().timestamp - frames[frames.size() - 2].timestamp) /
        FLAGS_view_speed);
    due_ += std::chrono::duration_cast<Clock::duration>(wait);
  }
  due_ = std::max(due_, Clock::now());
  while (Clock::now() < due_ && signal.name().empty() && !state_.is_stopped() &&
         !state_.is_paused()) {
    state_.WaitForControl(std::min(
        kSlice, std::chrono::duration_cast<milliseconds>(due_ - Clock::now()) +
                    milliseconds(1)));
  }
}

void LiveView::WaitWhilePaused(const StopSignal& signal) {
  Clock::time_point last_seen = Clock::now();
  while (state_.is_paused() && !state_.is_stopped() && signal.name().empty()) {
    if (state_.readers() > 0) last_seen = Clock::now();
    if (Clock::now() - last_seen > kAlone) state_.Pause(false);
    state_.WaitForControl(kSlice);
  }
}

}  // namespace rgbd_pose
