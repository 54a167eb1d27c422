#include "frontend/sources/corrected_source.h"

#include <cmath>
#include <limits>
#include <utility>

#include "frontend/frame/depth_warper.h"

namespace rgbd_pose {
namespace {

// Raw depths with their inverse moved by an offset (1/m).
cv::Mat Offset(const cv::Mat& depth, double scale, double offset) {
  cv::Mat moved(depth.size(), CV_16UC1);
  const double per_unit = offset / scale;
  for (int v = 0; v < depth.rows; ++v) {
    const auto* from = depth.ptr<uint16_t>(v);
    auto* to = moved.ptr<uint16_t>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const uint16_t raw = from[u];
      to[u] = 0;
      if (raw == 0 || raw == Frame::kNoDepth) continue;
      const double value = raw / (1.0 + per_unit * raw);
      if (value > 0.0 && value < Frame::kNoDepth - 1) {
        to[u] = static_cast<uint16_t>(std::lround(value));
      }
    }
  }
  return moved;
}

}  // namespace

Frame CorrectDepth(const RgbdCamera& camera, Frame frame) {
  if (camera.depth_correction.inverse_depth_offset != 0.0) {
    frame.depth = Offset(frame.depth, frame.depth_scale,
                         camera.depth_correction.inverse_depth_offset);
  }
  const Rigid3d& moved = camera.depth_correction.depth_from_color;
  if (moved.Angle() > 0.0 || !moved.translation.isZero(0.0)) {
    frame.depth =
        DepthWarper(camera.camera).Move(frame, moved.Inverse()).clone();
  }
  frame.color_shutter = camera.color_shutter;
  frame.depth_shutter = camera.depth_shutter;
  return frame;
}

std::optional<RgbdFrame> CorrectedSource::Next() {
  std::optional<RgbdFrame> next = source_->Next();
  if (!next.has_value()) return next;
  next->read = [this, read = std::move(next->read)] {
    return CorrectDepth(source_->camera(), read());
  };
  return next;
}

std::unique_ptr<FrameSource> ApplyDepthCorrection(
    std::unique_ptr<FrameSource> source) {
  const RgbdCamera& camera = source->camera();
  if (camera.depth_correction.IsIdentity() && camera.color_shutter.IsGlobal() &&
      camera.depth_shutter.IsGlobal() && !camera.color_shutter.is_known) {
    return source;
  }
  return std::make_unique<CorrectedSource>(std::move(source));
}

}  // namespace rgbd_pose
