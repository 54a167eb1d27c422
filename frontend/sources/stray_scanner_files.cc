#include "frontend/sources/stray_scanner_files.h"

#include <cmath>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kOdometryColumns[] =
    "timestamp, frame, x, y, z, qx, qy, qz, qw, ";
constexpr size_t kNumOdometryColumns = 9;

// The path of a numbered image, with or without leading zeros; empty: none.
std::string NumberedImage(const fs::path& folder, double number) {
  for (const char* name : {"%06.0f.png", "%.0f.png"}) {
    const fs::path path = folder / Format(name, number);
    if (PathExists(path)) return path.string();
  }
  return "";
}

StrayRow ParseRow(const fs::path& folder, const cv::Size& size,
                  const std::string& path, const TextLine& line) {
  std::vector<double> values;
  for (const std::string& word : line.words) {
    values.push_back(ParseNumber(word, path, line.number, "row of a frame"));
  }
  if (values.size() < kNumOdometryColumns) {
    throw InputError(path, line.number,
                     "needs 9 columns, has " + std::to_string(values.size()) +
                         "; was the file cut off?");
  }
  const Eigen::Quaterniond turn(values[8], values[5], values[6], values[7]);
  if (std::abs(turn.norm() - 1.0) > 0.01) {
    throw InputError(path, line.number, "the quaternion is not of unit length");
  }
  StrayRow row;
  row.timestamp = ParseTimestamp(line.words[0], path, line.number);
  row.world_from_cam = Rigid3d(turn, {values[2], values[3], values[4]});
  // Newer versions of the app add these columns.
  if (values.size() >= kNumOdometryColumns + 4) {
    row.camera = Camera{size.width, size.height, values[9],
                        values[10], values[11],  values[12]};
    RequireSound(row.camera->Check(),
                 Format("%s:%d: ", path.c_str(), line.number));
  }
  row.depth_path = NumberedImage(folder / "depth", values[1]);
  row.confidence_path = NumberedImage(folder / "confidence", values[1]);
  return row;
}

}  // namespace

std::vector<StrayRow> ReadStrayRows(const fs::path& folder,
                                    const cv::Size& size) {
  const std::string path = (folder / "odometry.csv").string();
  std::vector<TextLine> lines = ReadTextTable(path);
  if (lines.empty() ||
      (Join(lines[0].words) + ", ").rfind(kOdometryColumns, 0) != 0) {
    throw InputError(path + ": needs the columns " + kOdometryColumns +
                     "as Stray Scanner writes them since version 1.2");
  }
  std::vector<StrayRow> rows;
  for (size_t i = 1; i < lines.size(); ++i) {
    rows.push_back(ParseRow(folder, size, path, lines[i]));
    rows.back().image = static_cast<int>(i) - 1;
    if (i > 1 && rows[i - 1].timestamp <= rows[i - 2].timestamp) {
      throw InputError(path, lines[i].number,
                       "the time stamp is not after that of the previous row");
    }
  }
  return rows;
}

Camera ReadStrayCamera(const fs::path& folder, const cv::Size& size) {
  const std::string path = (folder / "camera_matrix.csv").string();
  std::vector<double> k;
  for (const TextLine& line : ReadTextTable(path)) {
    for (const std::string& word : line.words) {
      k.push_back(ParseNumber(word, path, line.number, "camera matrix"));
    }
  }
  if (k.size() != 9 || k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 ||
      k[7] != 0.0 || k[8] != 1.0) {
    throw InputError(path +
                     ": is not a camera matrix fx, 0, cx; 0, fy, cy; 0, 0, 1");
  }
  const Camera camera = {size.width, size.height, k[0], k[4], k[2], k[5]};
  RequireSound(camera.Check(), path + ": ");
  return camera;
}

}  // namespace rgbd_pose
