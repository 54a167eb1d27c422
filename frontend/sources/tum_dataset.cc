#include "frontend/sources/tum_dataset.h"

#include <filesystem>
#include <optional>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/image_file.h"
#include "frontend/sources/image_pairing.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

TumLists ReadLists(const SourceOptions& options) {
  const std::string problem = options.Check();
  if (!problem.empty()) throw InputError(problem);
  std::error_code error;
  if (!fs::is_directory(options.path, error)) {
    throw InputError(options.path +
                     ": no such folder; give the folder of a TUM RGB-D "
                     "sequence");
  }
  return options.associations_file.empty()
             ? ReadTumLists(options.path, options.max_time_difference)
             : ReadTumAssociations(options.path, options.associations_file);
}

// The size is that of the first image: the file does not say it.
CameraSetup ReadCalibrationText(const std::string& path,
                                const std::string& first_image) {
  const std::vector<TextLine> lines = ReadTextTable(path);
  if (lines.empty() || lines.front().words.size() != 4) {
    throw InputError(path + ": needs one line, fx fy cx cy");
  }
  double numbers[4];
  for (int i = 0; i < 4; ++i) {
    numbers[i] = ParseNumber(lines.front().words[i], path, lines.front().number,
                             "fx fy cx cy");
  }
  const cv::Mat image = ReadGrayImageFile(first_image);
  const Camera camera = {image.cols, image.rows, numbers[0],
                         numbers[1], numbers[2], numbers[3]};
  const std::string problem = camera.Check();
  if (!problem.empty()) throw InputError(path + ": " + problem);
  return CameraSetup(camera);
}

std::optional<CameraSetup> OwnCamera(const SourceOptions& options,
                                     const TumLists& lists) {
  if (options.camera.has_value()) return std::nullopt;  // nobody asks for it
  const fs::path folder = options.path;
  if (PathExists(folder / "camera.yaml")) {
    return ReadCameraFile((folder / "camera.yaml").string());
  }
  if (PathExists(folder / "calibration.txt")) {
    return ReadCalibrationText((folder / "calibration.txt").string(),
                               lists.pairs.front().color_path);
  }
  return std::nullopt;
}

}  // namespace

TumDataset::TumDataset(const SourceOptions& options)
    : folder_(options.path),
      lists_(ReadLists(options)),
      assembly_(ChooseCamera(options, OwnCamera(options, lists_)),
                options.keep_color) {}

Frame TumDataset::Read(int index) const {
  const ImagePair& pair = lists_.pairs[index];
  Frame frame = assembly_.Read(pair.color_path, pair.depth_path);
  frame.index = index;
  frame.timestamp = pair.timestamp;
  frame.depth_delay = pair.depth_delay;
  return frame;
}

Trajectory TumDataset::ground_truth() const {
  const fs::path path = fs::path(folder_) / "groundtruth.txt";
  if (!PathExists(path)) return {};
  truth_remarks_.clear();
  return ReadTrajectory(path.string(), &truth_remarks_);
}

std::vector<std::string> TumDataset::remarks() const {
  std::vector<std::string> lines = truth_remarks_;
  if (lists_.same_stamp > 0) {
    lines.push_back(SameStampRemark(folder_, lists_.same_stamp));
  }
  return lines;
}

}  // namespace rgbd_pose
