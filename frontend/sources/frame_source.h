#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "core/inertial/imu_calibration.h"
#include "core/inertial/imu_sample.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A frame of a source, not decoded yet.
struct RgbdFrame {
  double timestamp = 0.0;  // of the colour image, seconds

  // Decodes the frame, in any thread, while the source exists. Throws
  // InputError if an image is unreadable or does not fit the camera.
  std::function<Frame()> read;

  // The inertial samples after those of the frame before, see FrameSource::imu.
  // In a recording they reach ImuFeed::kReach beyond the stamp, so that they
  // cover the exposure of all rows, unless the sensor stops before.
  std::vector<ImuSample> imu = {};

  // The same frame with another index.
  RgbdFrame WithIndex(int index) const {
    return {timestamp,
            [read = read, index] {
              Frame frame = read();
              frame.index = index;
              return frame;
            },
            imu};
  }
};

// A source of RGB-D frames: a recording, a simulation or a camera. The time
// stamps of its frames strictly increase.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // The next frame; waits for it if necessary. Nothing after the last one. Must
  // be called from one thread at a time, and be quick: unlike RgbdFrame::read,
  // it does not run in parallel.
  virtual std::optional<RgbdFrame> Next() = 0;

  // The camera of all frames.
  virtual const RgbdCamera& camera() const = 0;

  // The time stamps of all frames (s) if they are known in advance, as in a
  // Dataset; empty otherwise.
  virtual std::vector<double> timestamps() const { return {}; }

  // The ground-truth path (world from camera) of the frames so far; empty if
  // there is none. Throws InputError if it cannot be read.
  virtual Trajectory ground_truth() const { return {}; }

  // The inertial sensor whose samples come with the frames, in its own axes and
  // with the stamps of its own clock; nothing if there is none.
  virtual std::optional<ImuSensor> imu() const { return std::nullopt; }

  // Number of colour images left out because they have no depth image.
  virtual int unmatched_color() const { return 0; }

  // Number of frames left out as they arrived faster than they were requested.
  virtual int dropped() const { return 0; }

  // What else users should know about what was left out or chosen, in lines.
  virtual std::vector<std::string> remarks() const { return {}; }
};

// A source whose frames can be read in any order: files or a simulation.
class Dataset : public FrameSource {
 public:
  // The number of frames, known before any image is read.
  virtual int size() const = 0;

  // The time stamp of frame `index`, s.
  virtual double timestamp(int index) const = 0;

  // Reads (or renders) frame `index`, 0 <= index < size(). May be called from
  // several threads at once. Throws what RgbdFrame::read throws.
  virtual Frame Read(int index) const = 0;

  // The interface of FrameSource. Calls of Read do not affect it.
  std::optional<RgbdFrame> Next() final {
    if (next_ == size()) return std::nullopt;
    const int index = next_++;
    return RgbdFrame{timestamp(index), [this, index] { return Read(index); }};
  }
  std::vector<double> timestamps() const final {
    std::vector<double> all(size());
    for (int i = 0; i < size(); ++i) all[i] = timestamp(i);
    return all;
  }

 private:
  int next_ = 0;
};

}  // namespace rgbd_pose
