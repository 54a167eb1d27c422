#pragma once

#include <string>

namespace rgbd_pose {

// What to do with frames whose motion is not found. Except after kStop, each is
// searched for among earlier references, and tracking continues if it is found.
enum class LostPolicy {
  kStop,        // every further frame is lost, without a search
  kHold,        // the last pose is reported until the place is found again
  kPredict,     // the pose continues with the last motion
  kNewSegment,  // a new segment starts there; for a while, each of its frames
                // is searched for in the previous segment
};

// How the exposure times of the rows of a frame are used.
enum class ShutterUse {
  kCamera,  // exposure times of the frame are compensated by the velocity found
  kNone,    // everything counts as seen at the stamp of the frame
};

// When to change the reference, where to start, when to give up.
struct OdometryOptions {
  // A new reference is taken when a smaller share of the reference agrees, or
  // when the reference has moved by more than this in the image on average.
  double min_reference_share = 0.5;
  double max_flow_px = 60.0;

  // Tracking starts from the last pose; if true, from the last pose moved on at
  // constant velocity.
  bool predict_velocity = false;

  // What to do with frames whose motion is not found.
  LostPolicy on_lost = LostPolicy::kNewSegment;

  // Whether to compensate that rows are exposed one after another and that
  // depth is exposed at another time than colour.
  ShutterUse shutter = ShutterUse::kCamera;

  // How long (s) the previous segment is searched for after a new one starts.
  double new_segment_after = 1.5;

  // Standard deviations of a motion guess between two frames that comes without
  // a covariance.
  double guess_sigma_rotation = 0.01;     // rad
  double guess_sigma_translation = 0.01;  // m

  // Returns one line that says what is wrong with the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
