#pragma once

#include <string>
#include <vector>

#include "tests/support/track_sequence.h"

// Rendered sequences of cameras with rolling shutters.

namespace rgbd_pose {

struct Shutters {
  Shutter color, depth;
  double depth_delay = 0.0;
};

// Shutters of a handheld sensor; `sign` is -1 if the last row is first.
inline Shutters RollingShutters(double sign) {
  return {{-0.0075, sign * 0.028}, {-0.018, sign * 0.028}};
}

inline SyntheticOptions ShutterOptions(const std::string& path,
                                       const Shutters& shutters) {
  SyntheticOptions options;
  options.path = path;
  options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5};
  options.color_shutter = shutters.color;
  options.depth_shutter = shutters.depth;
  options.depth_delay_s = shutters.depth_delay;
  return options;
}

inline constexpr int kShutterFrames = 40;

// The first frames of a path, rendered once.
struct ShutterSequence {
  ShutterSequence(const std::string& path, const Shutters& shutters,
                  int count = kShutterFrames)
      : dataset(ShutterOptions(path, shutters)) {
    for (int i = 0; i < count; ++i) frames.push_back(dataset.Read(i));
  }

  Rigid3d Motion(int ref, int cur) const {
    return dataset.WorldFromCam(cur).Inverse() * dataset.WorldFromCam(ref);
  }

  SyntheticDataset dataset;
  std::vector<Frame> frames;
};

inline Odometry OdometryFor(const ShutterSequence& sequence,
                            const std::string& tracker, ShutterUse use) {
  OdometryOptions options;
  options.shutter = use;
  return Odometry(
      options,
      MakeTracker(tracker, PartsFor(sequence.dataset.camera().camera)));
}

}  // namespace rgbd_pose
