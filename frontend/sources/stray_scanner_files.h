#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A row of odometry.csv of the app Stray Scanner, for one image of the video.
struct StrayRow {
  double timestamp = 0.0;        // s
  Rigid3d world_from_cam;        // by ARKit; the app has turned the camera axes
  std::optional<Camera> camera;  // of this image, whose focus varies
  int image = 0;                 // number in the video
  std::string depth_path;        // empty: none
  std::string confidence_path;
};

// Reads odometry.csv for a video of this size. Throws InputError for other
// columns, invalid values, and time stamps that do not increase.
std::vector<StrayRow> ReadStrayRows(const std::filesystem::path& folder,
                                    const cv::Size& size);

// Reads camera_matrix.csv, the camera of a video of this size. Throws
// InputError if it is no camera matrix.
Camera ReadStrayCamera(const std::filesystem::path& folder,
                       const cv::Size& size);

}  // namespace rgbd_pose
