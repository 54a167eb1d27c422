#include "frontend/sources/frame_assembly.h"

#include <cmath>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/depth_warper.h"
#include "frontend/sources/masks.h"

namespace rgbd_pose {
namespace {

cv::Size SizeOf(const Camera& camera) { return {camera.width, camera.height}; }

void CheckSize(const FrameAssembly::Named& named, const cv::Size& size,
               const char* camera, const char* advice) {
  if (named.image.size() == size) return;
  throw InputError(named.name +
                   Format(": is %d x %d pixels, the %s has %d x %d; %s",
                          named.image.cols, named.image.rows, camera,
                          size.width, size.height, advice));
}

constexpr char kOtherCamera[] = "is it the right camera file or preset?";

// Raw depths after an offset (1/m) is added to their inverse.
cv::Mat Offset(const cv::Mat& depth, double scale, double offset) {
  cv::Mat moved = depth.clone();
  const double per_unit = offset / scale;
  for (uint16_t& raw : cv::Mat_<uint16_t>(moved)) {
    const double value = raw / (1.0 + per_unit * raw);
    const bool is_depth =
        raw != Frame::kNoDepth && value > 0.0 && value < Frame::kNoDepth - 1;
    raw = is_depth ? static_cast<uint16_t>(std::lround(value)) : 0;
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
      depth_size_(SizeOf(camera_.camera)),
      keep_color_(keep_color),
      is_upside_down_(setup.is_upside_down) {
  if (!setup.depth_camera.has_value()) return;
  depth_size_ = SizeOf(setup.depth_camera->camera);
  registration_ =
      std::make_shared<DepthRegistration>(*setup.depth_camera, camera_.camera);
}

cv::Mat FrameAssembly::Upright(const cv::Mat& image) const {
  if (!is_upside_down_) return image;
  cv::Mat turned;
  cv::flip(image, turned, /*flipCode=*/0);  // rows from the bottom
  return turned;
}

Frame FrameAssembly::Make(Frame frame, const Named& gray, const cv::Mat& color,
                          const Named& depth) const {
  CheckSize(gray, SizeOf(camera_.camera), "camera", kOtherCamera);
  if (registration_ == nullptr) {
    CheckSize(depth, depth_size_, "camera",
              "if another camera took depth, give both (a Kalibr file: camera, "
              "depth_camera)");
  } else {
    CheckSize(depth, depth_size_, "depth camera", kOtherCamera);
  }
  frame.gray = Upright(gray.image);
  if (keep_color_) frame.color = Upright(color);
  frame.depth = registration_ == nullptr
                    ? Upright(depth.image)
                    : registration_->Register(depth.image, camera_.depth_scale);
  frame.depth_scale = camera_.depth_scale;
  return CorrectDepth(camera_, std::move(frame));
}

Frame FrameAssembly::Read(Frame frame, const std::string& color_path,
                          const std::string& depth_path,
                          const DepthReader& read_depth) const {
  cv::Mat color;
  const cv::Mat gray =
      ReadGrayImageFile(color_path, keep_color_ ? &color : nullptr);
  Frame made = Make(std::move(frame), {gray, color_path}, color,
                    {read_depth(depth_path), depth_path});
  const std::string mask_path = MaskPath(color_path);
  if (mask_path.empty()) return made;
  const Named mask = {ReadGrayImageFile(mask_path, nullptr), mask_path};
  CheckSize(mask, SizeOf(camera_.camera), "camera", kOtherCamera);
  made.depth = made.depth.clone();  // it may be shared
  made.depth.setTo(0, Upright(mask.image) == 0);
  return made;
}

}  // namespace rgbd_pose
