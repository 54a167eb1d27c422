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

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/mapping/map_update.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// A frame on the page. Where it is hangs on its keyframe: a loop moves that.
struct ViewFrame {
  double timestamp = 0.0;  // s
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;
  double track_ms = 0.0;
  int matches = 0;
  int inliers = 0;
  double sigma = 0.0;
  int segment = 0;
  std::optional<int> keyframe;  // by id; nothing: it was lost
  Rigid3d keyframe_from_cam;
};

// A keyframe and some of the points that it sees, see SamplePoints.
struct ViewKeyframe {
  int id = 0;
  std::string points;
};

// The images of a frame and its matches. They share the frame's memory.
struct ViewImages {
  cv::Mat gray;                  // CV_8UC1
  cv::Mat depth;                 // CV_16UC1
  double depth_scale = 5000.0;   // raw units per metre
  std::vector<cv::Vec4f> moves;  // of matches: from and to, px (u, v, u, v)
  std::vector<float> weights;    // of these, 0 to 1; empty: not known
};

// What a page has been told so far, or what it is told now: all that came after
// a cursor.
struct ViewNews {
  std::vector<ViewFrame> frames;
  std::vector<ViewKeyframe> keyframes;
  std::vector<MapLink> links;
  // Of all keyframes, map_from_cam; empty: none has moved.
  std::map<int, Rigid3d> poses;
  std::optional<ViewImages> images;
  int images_index = -1;  // of their frame
  bool is_paused = false;
  std::string results;  // after the end: where they are
  bool is_finished = false;
};

// How far a reader is.
struct ViewCursor {
  size_t frames = 0;
  size_t keyframes = 0;
  size_t links = 0;
  int poses = 0;  // versions of these
  int images = 0;
  int controls = 0;
};

// What live pages show: written by the thread that tracks, read by any number
// of others. Whoever holds its lock only copies.
class ViewState {
 public:
  // Adds what is new; poses and images replace earlier ones.
  void Add(ViewNews news);
  // The last call: says where results are.
  void Finish(const std::string& results);

  // What is new since the cursor, waiting for it up to `patience`. Long
  // histories come in parts.
  ViewNews Next(std::chrono::milliseconds patience, ViewCursor* cursor);

  // Pages that are open now.
  int readers() const { return readers_; }
  void AddReaders(int more);

  // The buttons.
  void Pause(bool is_paused);
  void Stop();
  bool is_stopped() const;
  bool is_paused() const;
  // Waits up to `patience` as long as nobody presses one.
  void WaitForControl(std::chrono::milliseconds patience);

 private:
  void ThinPoints();

  mutable std::mutex mutex_;
  std::condition_variable changed_, control_;
  ViewNews all_;
  size_t point_bytes_ = 0;
  int poses_ = 0, images_ = 0, controls_ = 0;
  bool is_stopped_ = false;
  std::atomic<int> readers_{0};
};

// A point on the page: x, y, z in camera axes (mm, 16 bits each, signed, low
// byte first) and its gray level.
constexpr size_t kViewPointBytes = 7;

// Some points that a frame sees, in random order, so that the first n are a
// picture of all.
std::string SamplePoints(const Frame& frame, const Camera& camera);

}  // namespace rgbd_pose
