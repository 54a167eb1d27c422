#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "core/geometry/camera.h"
#include "frontend/files/camera_setup.h"
#include "frontend/frame/depth_registration.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A frame without the errors of depth that a camera is known to have
// (RgbdCamera): the offset of its inverse depth, of its registration; and with
// the camera's shutters.
Frame CorrectDepth(const RgbdCamera& camera, Frame frame);

// Makes frames of a recording's images, the same way for all sources: their
// sizes checked, depth registered to colour where it is not, and corrected.
class FrameAssembly {
 public:
  // Throws InputError for cameras that make no sense.
  FrameAssembly(const CameraSetup& setup, bool keep_color);

  // Of the frames.
  const RgbdCamera& camera() const { return camera_; }

  // Whether sources are to decode colours for Make.
  bool keep_color() const { return keep_color_; }

  // An image and what to call it in messages.
  struct Named {
    cv::Mat image;     // decoded
    std::string name;  // its path, say
  };

  // A frame of decoded images: gray CV_8UC1 (with the colours, if they are
  // kept) and depth CV_16UC1, with no time stamps yet. Throws InputError if
  // they do not fit their cameras. From any thread.
  Frame Make(const Named& gray, const cv::Mat& color, const Named& depth) const;

  // The same of two files.
  Frame Read(const std::string& color_path,
             const std::string& depth_path) const;

 private:
  RgbdCamera camera_;
  int depth_width_;
  int depth_height_;
  bool keep_color_;
  std::shared_ptr<const DepthRegistration> registration_;  // null: not needed
};

}  // namespace rgbd_pose
