#pragma once

#include <string>

namespace rgbd_pose {

// What to do with frames whose motion is not found. Whatever it is, every frame
// is searched for among earlier references, and tracking goes on if it is
// found.
enum class LostPolicy {
  kStop,        // every further frame is lost
  kHold,        // the last pose is reported until the place is found again
  kPredict,     // the pose moves on as it moved last
  kNewSegment,  // a new segment starts there, and the one before is searched
                // for from each of its frames for a while
};

// What is done about the times at which the rows of a frame were exposed.
enum class ShutterUse {
  kCamera,  // what the frame says of them is undone, by the velocity found
  kNone,    // all counts as seen at the frame's stamp
};

// When to change the reference, where to look, when to give up.
struct OdometryOptions {
  // A new reference is taken when less of the reference agrees, or when that
  // has moved further than this on average.
  double min_reference_share = 0.5;
  double max_flow_px = 60.0;

  // What tracking starts from: the last pose, moved on at constant velocity if
  // asked for.
  bool predict_velocity = false;

  // What becomes of frames whose motion is not found.
  LostPolicy on_lost = LostPolicy::kNewSegment;

  // Whether to undo that rows are exposed one after another and depth at
  // another time than colour.
  ShutterUse shutter = ShutterUse::kCamera;

  // How long (s) the segment before is searched for after a new one started.
  double new_segment_after = 1.5;

  // Standard deviations of a motion guess between two frames that comes without
  // a covariance.
  double guess_sigma_rotation = 0.01;     // rad
  double guess_sigma_translation = 0.01;  // m

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
