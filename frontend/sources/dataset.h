#pragma once

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

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
