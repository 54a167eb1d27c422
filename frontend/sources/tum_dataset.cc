#include "frontend/sources/tum_dataset.h"

#include <filesystem>

#include "core/util/input_error.h"
#include "frontend/sources/image_file.h"

namespace rgbd_pose {

TumDataset::TumDataset(const SourceOptions& options)
    : camera_(options.camera), keep_color_(options.keep_color) {
  const std::string problem = options.Check();
  if (!problem.empty()) throw InputError(problem);
  std::error_code error;
  if (!std::filesystem::is_directory(options.path, error)) {
    throw InputError(options.path +
                     ": no such folder; give the folder of a TUM RGB-D "
                     "sequence");
  }
  lists_ = options.associations_file.empty()
               ? ReadTumLists(options.path, options.max_time_difference)
               : ReadTumAssociations(options.path, options.associations_file);
}

Frame TumDataset::Read(int index) const {
  const ImagePair& pair = lists_.pairs[index];
  Frame frame;
  frame.index = index;
  frame.timestamp = pair.timestamp;
  frame.depth_delay = pair.depth_delay;
  frame.gray =
      ReadGrayImageFile(pair.color_path, keep_color_ ? &frame.color : nullptr);
  frame.depth = ReadDepthImageFile(pair.depth_path);
  frame.depth_scale = camera_.depth_scale;
  CheckSize(frame.gray, pair.color_path);
  CheckSize(frame.depth, pair.depth_path);
  return frame;
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
