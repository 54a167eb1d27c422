#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/slam/mapper.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// A frame without edges; its pose in a keyframe, which loop closures move.
struct ViewFrame : TrackedFrame {
  std::optional<int> keyframe;  // id; empty: the frame was lost
  Rigid3d keyframe_from_cam;
};

// A keyframe and a sample of its visible points, see SamplePoints.
struct ViewKeyframe {
  int id = 0;
  std::string points;
};

// The images and matches of a frame. They share the frame's memory.
struct ViewImages {
  cv::Mat gray;                 // CV_8UC1
  cv::Mat depth;                // CV_16UC1
  double depth_scale = 5000.0;  // raw units per metre

  // Matches: from and to, px (u, v, u, v), and weight, 0 to 1; -1: unknown.
  std::vector<cv::Vec<float, 5>> moves;
};

// The state of a page: either everything so far, or everything after a cursor.
struct ViewNews {
  std::vector<ViewFrame> frames;
  std::vector<ViewKeyframe> keyframes;
  std::vector<MapEdge> links;
  // Poses map_from_cam of all keyframes; empty if no keyframe has moved.
  std::map<int, Rigid3d> poses;
  std::optional<ViewImages> images;
  int images_index = -1;  // number of the frame
  bool is_paused = false;
  std::string results;  // after the end: location of the results
  bool is_finished = false;
};

// Formats news as events for the browser (text/event-stream): always "news",
// and "end" after the last frame; images and matches as an event "images",
// which takes milliseconds.
std::string FormatNews(const ViewNews& news);
std::string FormatImages(const ViewImages& images, int index);

// The position of a reader in the news.
struct ViewCursor {
  size_t frames = 0;
  size_t keyframes = 0;
  size_t links = 0;
  int poses = 0;  // version of the poses
  int images = 0;
  int controls = 0;
};

// The data shown by live pages, written by the tracking thread and read by any
// number of other threads. The lock is only held for copying.
class ViewState {
 public:
  // Adds news. Poses and images replace earlier ones.
  void Add(ViewNews news);
  // Sets the location of the results. This is the last call.
  void Finish(const std::string& results);

  // Waits up to `patience` for news since the cursor; long ones come in parts.
  ViewNews Next(std::chrono::milliseconds patience, ViewCursor* cursor);

  // The number of open pages.
  int readers() const { return readers_; }
  void AddReaders(int more) { readers_ += more; }

  void Pause(bool is_paused);
  void Stop();
  bool is_stopped() const;
  bool is_paused() const;
  // Waits up to `patience` for a button press.
  void WaitForControl(std::chrono::milliseconds patience);

 private:
  // Applies a button or the end of the run, and wakes all waiting threads.
  template <typename Change>
  void Control(const Change& change);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  ViewNews all_;
  size_t point_bytes_ = 0;
  int poses_ = 0, images_ = 0, controls_ = 0;
  bool is_stopped_ = false;
  std::atomic<int> readers_{0};
};

// Bytes of a point on the page: x, y, z in camera axes (mm, 16 bits each,
// signed, low byte first), then red, green and blue.
constexpr size_t kViewPointBytes = 9;

// Samples visible points in random order: the first n cover the whole view.
// `color`: as Frame::color; grey levels are taken if it is empty.
std::string SamplePoints(const Frame& frame, const cv::Mat& color,
                         const Camera& camera);

// ViewImages::moves of a frame with a known velocity: where its rows were
// exposed, not as at the time stamp. `weights` are those of MotionEstimate.
std::vector<cv::Vec<float, 5>> MatchesInImage(
    const Frame& frame, const Camera& camera, const Correspondences& matches,
    const std::vector<double>& weights);

}  // namespace rgbd_pose
