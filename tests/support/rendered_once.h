#pragma once

#include <map>

#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {

// A simulated sequence that renders a frame only when it is first read, for
// tests that share it: rendering takes longer than tracking.
class RenderedOnce : public SyntheticDataset {
 public:
  using SyntheticDataset::SyntheticDataset;

  Frame Read(int index) const override {
    auto frame = frames_.find(index);
    if (frame == frames_.end()) {
      frame = frames_.emplace(index, SyntheticDataset::Read(index)).first;
    }
    return frame->second.Clone();
  }

 private:
  mutable std::map<int, Frame> frames_;  // by index
};

}  // namespace rgbd_pose
