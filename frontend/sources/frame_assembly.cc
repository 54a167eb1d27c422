#include "frontend/sources/frame_assembly.h"

#include "core/util/input_error.h"
#include "frontend/files/image_file.h"

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

}  // namespace

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
  return frame;
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
