#include "frontend/sources/camera_matrix.h"

#include <opencv2/core.hpp>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/image_file.h"

namespace rgbd_pose {

Camera ReadCameraMatrix(const std::string& path,
                        const std::string& image_path) {
  const std::vector<TextLine> lines = ReadTextTable(path);
  if (lines.size() < 3 || lines[0].words.size() < 3 ||
      lines[1].words.size() < 3) {
    throw InputError(path + ": needs a camera matrix, row by row");
  }
  const auto number = [&](int row, int column) {
    return ParseNumber(lines[row].words[column], path, lines[row].number,
                       "camera matrix");
  };
  const cv::Mat image = ReadImageFile(image_path);
  const Camera camera = {image.cols,   image.rows,   number(0, 0),
                         number(1, 1), number(0, 2), number(1, 2)};
  RequireSound(camera.Check(), path + ": ");
  return camera;
}

}  // namespace rgbd_pose
