#pragma once

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A source that can be read in any order, as files and simulations can.
class Dataset : public FrameSource {
 public:
  // The number of frames, known before any image is read.
  virtual int size() const = 0;

  // The time stamp of frame `index` in seconds.
  virtual double timestamp(int index) const = 0;

  // Reads (or makes) frame `index`, 0 <= index < size(). May be called from
  // several threads at once. Throws as RgbdFrame::read.
  virtual Frame Read(int index) const = 0;

  // As a source, which Read does not disturb.
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
