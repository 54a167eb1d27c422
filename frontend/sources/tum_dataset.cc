#include "frontend/sources/tum_dataset.h"

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "core/util/input_error.h"
#include "frontend/sources/image_file.h"

namespace rgbd_pose {

TumDataset::TumDataset(const TumDatasetOptions& options)
    : camera_(options.camera) {
  const std::string problem = camera_.camera.Check();
  if (!problem.empty()) throw InputError("camera: " + problem);
  if (!std::isfinite(camera_.depth_scale) || camera_.depth_scale <= 0.0) {
    throw InputError("the depth scale must be a positive number");
  }
  if (!(options.max_time_difference >= 0.0)) {
    throw InputError("the time difference must not be negative");
  }
  std::error_code error;
  if (!std::filesystem::is_directory(options.folder, error)) {
    throw InputError(options.folder +
                     ": no such folder; give the folder of a TUM RGB-D "
                     "sequence");
  }
  lists_ = options.associations_file.empty()
               ? ReadTumLists(options.folder, options.max_time_difference)
               : ReadTumAssociations(options.folder, options.associations_file);
}

Frame TumDataset::Read(int index) const {
  const ImagePair& pair = lists_.pairs[index];
  Frame frame;
  frame.index = index;
  frame.timestamp = pair.timestamp;
  frame.gray = ReadGrayImageFile(pair.color_path);
  frame.depth = ReadDepthImageFile(pair.depth_path);
  frame.depth_scale = camera_.depth_scale;
  CheckSize(frame.gray, pair.color_path);
  CheckSize(frame.depth, pair.depth_path);
  return frame;
}

cv::Mat TumDataset::ReadColor(int index) const {
  const std::string& path = lists_.pairs[index].color_path;
  cv::Mat color = ReadImageFile(path, cv::IMREAD_COLOR);
  CheckSize(color, path);
  return color;
}

void TumDataset::CheckSize(const cv::Mat& image,
                           const std::string& path) const {
  const Camera& camera = camera_.camera;
  if (image.cols == camera.width && image.rows == camera.height) return;
  throw InputError(path + ": is " + std::to_string(image.cols) + " x " +
                   std::to_string(image.rows) + " pixels, the camera has " +
                   std::to_string(camera.width) + " x " +
                   std::to_string(camera.height) +
                   "; is it the right camera file or preset?");
}

}  // namespace rgbd_pose
