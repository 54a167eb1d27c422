#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A frame as it comes from a source: most of the work is yet to be done.
struct RgbdFrame {
  double timestamp = 0.0;  // of the colour image, seconds

  // Decodes it; in any thread, at the same time as other frames, as long as the
  // source is there. Throws InputError if an image is unreadable or does not
  // fit the camera.
  std::function<Frame()> read;
};

// Where RGB-D frames come from, in the order of their time stamps, which
// strictly increase: a recording, a simulation, a camera.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // The next frame, waiting for it if need be; nothing after the last one. From
  // one thread at a time. Should be quick, as it cannot be shared out:
  // RgbdFrame::read can.
  virtual std::optional<RgbdFrame> Next() = 0;

  // Camera that all frames share.
  virtual const RgbdCamera& camera() const = 0;

  // The time stamps of all frames (s) if they are known ahead, as those of a
  // recording are; empty otherwise.
  virtual std::vector<double> timestamps() const { return {}; }

  // The true path (world from camera) that came with the frames so far; empty
  // if there is none. Throws InputError if it cannot be read.
  virtual Trajectory ground_truth() const { return {}; }

  // How many colour images make no frame since they have no depth image.
  virtual int unmatched_color() const { return 0; }

  // How many frames of a camera came faster than they were asked for, and were
  // left out.
  virtual int dropped() const { return 0; }

  // What else was left out or chosen so far that users should know, a line
  // each.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace rgbd_pose
