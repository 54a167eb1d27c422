#pragma once

#include <string>

#include "frontend/frame/frame.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"

// Frames of a small camera, rendered without noise, with any shutter and with
// the velocity that the path has: by default in the hand.

namespace rgbd_pose {

inline SyntheticOptions HandheldOptions(const std::string& path = "handheld") {
  SyntheticOptions options;
  options.path = path;
  options.frames = 60;
  options.noise = false;
  options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
  return options;
}

// The path's velocity at the time stamp of a frame, and how it changes.
inline Twist TwistOfPath(int index, const SyntheticOptions& options) {
  constexpr double kStep = 1e-3;  // s
  const SyntheticPath path = FindSyntheticPath(options.path);
  const double t = index / options.rate_hz;
  const double duration = (options.frames - 1) / options.rate_hz;
  const auto between = [&](double from, double to) {
    return TwistOf(path(to, duration).Inverse() * path(from, duration),
                   to - from);
  };
  Twist twist = between(t - kStep, t + kStep);
  const Twist change = between(t, t + kStep) - between(t - kStep, t);
  twist.angular_acceleration = change.angular / kStep;
  twist.linear_acceleration = change.linear / kStep;
  return twist;
}

// A frame with its velocity.
inline Frame HandheldFrame(int index, const Shutter& color,
                           const Shutter& depth,
                           const std::string& path = "handheld") {
  SyntheticOptions options = HandheldOptions(path);
  options.color_shutter = color;
  options.depth_shutter = depth;
  Frame frame = SyntheticDataset(options).Read(index);
  frame.twist = TwistOfPath(index, options);
  return frame;
}

// A frame of a camera whose rows are exposed from the top, depth first.
inline Frame RollingFrame(int index) {
  return HandheldFrame(index, {-0.0075, 0.028}, {-0.018, 0.028});
}

// The motion between the time stamps of two frames.
inline Rigid3d HandheldMotion(int ref, int cur) {
  const SyntheticDataset dataset(HandheldOptions());
  return dataset.WorldFromCam(cur).Inverse() * dataset.WorldFromCam(ref);
}

}  // namespace rgbd_pose
