#include "frontend/sources/frame_assembly.h"

#include <cmath>
#include <utility>

#include "core/util/input_error.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/depth_warper.h"

namespace rgbd_pose {
namespace {

void CheckSize(const FrameAssembly::Named& named, int width, int height,
               const char* camera) {
  if (named.image.cols == width && named.image.rows == height) return;
  throw InputError(named.name + ": is " + std::to_string(named.image.cols) +
                   " x " + std::to_string(named.image.rows) + " pixels, the " +
                   camera + " has " + std::to_string(width) + " x " +
                   std::to_string(height) +
                   "; is it the right camera file or preset?");
}

// Raw depths after an offset (1/m) is added to their inverse.
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
  if (!moved.IsIdentity()) {
    frame.depth =
        DepthWarper(camera.camera).Move(frame, moved.Inverse()).clone();
  }
  frame.color_shutter = camera.color_shutter;
  frame.depth_shutter = camera.depth_shutter;
  return frame;
}

FrameAssembly::FrameAssembly(const CameraSetup& setup, bool keep_color)
    : camera_(RegisteredCamera(setup)),
      depth_width_(camera_.camera.width),
      depth_height_(camera_.camera.height),
      keep_color_(keep_color) {
  if (!setup.depth_camera.has_value()) return;
  depth_width_ = setup.depth_camera->camera.width;
  depth_height_ = setup.depth_camera->camera.height;
  registration_ =
      std::make_shared<DepthRegistration>(*setup.depth_camera, camera_.camera);
}

Frame FrameAssembly::Make(const Named& gray, const cv::Mat& color,
                          const Named& depth) const {
  CheckSize(gray, camera_.camera.width, camera_.camera.height, "camera");
  CheckSize(depth, depth_width_, depth_height_,
            registration_ == nullptr ? "camera" : "depth camera");
  Frame frame;
  frame.gray = gray.image;
  if (keep_color_) frame.color = color;
  frame.depth = registration_ == nullptr
                    ? depth.image
                    : registration_->Register(depth.image, camera_.depth_scale);
  frame.depth_scale = camera_.depth_scale;
  return CorrectDepth(camera_, std::move(frame));
}

Frame FrameAssembly::Read(const std::string& color_path,
                          const std::string& depth_path) const {
  cv::Mat color;
  const cv::Mat gray =
      ReadGrayImageFile(color_path, keep_color_ ? &color : nullptr);
  return Make({gray, color_path}, color,
              {ReadDepthImageFile(depth_path), depth_path});
}

}  // namespace rgbd_pose
