#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A frame without the errors of depth that a camera is known to have
// (RgbdCamera): the offset of its inverse depth, of its registration; and with
// the camera's shutters.
Frame CorrectDepth(const RgbdCamera& camera, Frame frame);

// The frames of another source, corrected so.
class CorrectedSource final : public FrameSource {
 public:
  explicit CorrectedSource(std::unique_ptr<FrameSource> source)
      : source_(std::move(source)) {}

  std::optional<RgbdFrame> Next() override;
  const RgbdCamera& camera() const override { return source_->camera(); }
  std::vector<double> timestamps() const override {
    return source_->timestamps();
  }
  Trajectory ground_truth() const override { return source_->ground_truth(); }
  int unmatched_color() const override { return source_->unmatched_color(); }
  int dropped() const override { return source_->dropped(); }
  std::vector<std::string> remarks() const override {
    return source_->remarks();
  }

 private:
  std::unique_ptr<FrameSource> source_;
};

// The source itself where there is nothing to correct.
std::unique_ptr<FrameSource> ApplyDepthCorrection(
    std::unique_ptr<FrameSource> source);

}  // namespace rgbd_pose
