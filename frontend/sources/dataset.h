#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "frontend/image/frame.h"

namespace rgbd_pose {

// A sequence of RGB-D frames with strictly increasing time stamps.
class Dataset {
 public:
  virtual ~Dataset() = default;

  // The number of frames, known before any image is read.
  virtual int size() const = 0;

  // The time stamp of frame `index` in seconds.
  virtual double timestamp(int index) const = 0;

  // Reads (or makes) frame `index`, 0 <= index < size(). May be called from
  // several threads at once. Throws InputError if an image is unreadable or
  // does not fit the camera.
  virtual Frame Read(int index) const = 0;

  // Camera that all frames share.
  virtual const RgbdCamera& camera() const = 0;
};

}  // namespace rgbd_pose
