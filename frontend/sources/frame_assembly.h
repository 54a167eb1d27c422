#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "core/geometry/camera.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/depth_registration.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Corrects the known depth errors of a camera (DepthCorrection) in a frame and
// sets the frame's shutters to those of the camera.
Frame CorrectDepth(const RgbdCamera& camera, Frame frame);

// Makes frames from images, in the same way for all sources: checks image
// sizes, registers depth to colour if needed, corrects depth.
class FrameAssembly {
 public:
  // Throws InputError for invalid cameras.
  FrameAssembly(const CameraSetup& setup, bool keep_color);

  // The camera of the finished frames.
  const RgbdCamera& camera() const { return camera_; }

  // Whether sources must decode colours for Make.
  bool keep_color() const { return keep_color_; }

  // An image and its name in messages.
  struct Named {
    cv::Mat image;     // decoded
    std::string name;  // for example its path
  };

  // Completes a frame with index and stamps by gray CV_8UC1, the colours if
  // they are kept, and depth CV_16UC1. Throws InputError if the images do not
  // fit their cameras. Thread-safe.
  Frame Make(Frame frame, const Named& gray, const cv::Mat& color,
             const Named& depth) const;

  // Whether images are turned upside down, see CameraSetup.
  bool is_upside_down() const { return is_upside_down_; }

  // Reads a file of depth, CV_16UC1.
  using DepthReader = std::function<cv::Mat(const std::string& path)>;

  // The same from two files, and the mask of the colour image if there is one
  // (docs/sources.md): where it is 0, the frame has no depth.
  Frame Read(Frame frame, const std::string& color_path,
             const std::string& depth_path,
             const DepthReader& read_depth = ReadDepthImageFile) const;

 private:
  cv::Mat Upright(const cv::Mat& image) const;

  RgbdCamera camera_;
  cv::Size depth_size_;
  bool keep_color_;
  bool is_upside_down_;                                    // see CameraSetup
  std::shared_ptr<const DepthRegistration> registration_;  // null: not needed
};

}  // namespace rgbd_pose
