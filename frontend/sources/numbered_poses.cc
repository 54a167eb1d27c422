#include <cmath>
#include <filesystem>

#include "core/evaluation/trajectory.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/sources/numbered_layouts.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// Appends the numbers of a line to a 4 x 4 matrix, row by row. In a lost frame
// they are infinite or NaN, here always NaN.
void AddNumbers(const TextLine& line, const std::string& path,
                std::vector<double>* matrix) {
  for (const std::string& word : line.words) {
    if (matrix->size() == 16) {
      throw InputError(path, line.number, "has more than 4 x 4 numbers");
    }
    const bool is_lost =
        word == "-inf" || word == "inf" || word == "nan" || word == "-nan";
    matrix->push_back(is_lost ? NAN
                              : ParseNumber(word, path, line.number, "pose"));
  }
}

// Stores the pose of a 4 x 4 matrix unless its frame is lost.
void AddPose(const std::vector<double>& m, int number, const std::string& path,
             int line, NumberedPoses* poses) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(
      m.data());
  if (!matrix.allFinite()) return;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  // Tolerates values with few digits.
  const double error =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(error < 0.05) || !(rotation.determinant() > 0.0)) {
    throw InputError(path, line,
                     "not a pose: the upper left 3 x 3 is not a rotation");
  }
  (*poses)[number] = Rigid3d(Eigen::Quaterniond(rotation), {m[3], m[7], m[11]});
}

}  // namespace

NumberedPoses ReadPoseFiles(const NumberedFolder& folder, const char* name) {
  NumberedPoses poses;
  for (const NumberedFrame& frame : folder.frames) {
    const std::string path =
        (folder.path / Format(name, frame.number)).string();
    if (!PathExists(path)) continue;
    std::vector<double> matrix;
    for (const TextLine& line : ReadTextTable(path)) {
      AddNumbers(line, path, &matrix);
    }
    if (matrix.size() < 16) {
      throw InputError(path + ": needs 4 rows of 4 numbers");
    }
    AddPose(matrix, frame.number, path, 1, &poses);
  }
  return poses;
}

NumberedPoses ReadPoseLines(const NumberedFolder& folder) {
  const std::string path = (folder.path / "traj.txt").string();
  NumberedPoses poses;
  if (!PathExists(path)) return poses;
  size_t i = 0;
  for (const TextLine& line : ReadTextTable(path)) {
    if (i == folder.frames.size()) break;  // the rest are of missing frames
    if (line.words.size() != 16) {
      throw InputError(path, line.number,
                       "needs the 16 numbers of a 4 x 4 matrix, has " +
                           std::to_string(line.words.size()));
    }
    std::vector<double> matrix;
    AddNumbers(line, path, &matrix);
    AddPose(matrix, folder.frames[i++].number, path, line.number, &poses);
  }
  return poses;
}

NumberedPoses ReadPoseLog(const NumberedFolder& folder) {
  const std::string path = (folder.path / "trajectory.log").string();
  NumberedPoses poses;
  if (!PathExists(path)) return poses;
  const std::vector<TextLine> lines = ReadTextTable(path);
  for (size_t i = 0; i < folder.frames.size() && 5 * i < lines.size(); ++i) {
    const TextLine& head = lines[5 * i];
    if (head.words.size() != 3 || 5 * i + 4 >= lines.size()) {
      throw InputError(path, head.number,
                       "needs three integers and then 4 rows of 4 numbers");
    }
    std::vector<double> matrix;
    for (int row = 1; row <= 4; ++row) {
      const TextLine& line = lines[5 * i + row];
      if (line.words.size() != 4) {
        throw InputError(path, line.number, "needs a row of 4 numbers");
      }
      AddNumbers(line, path, &matrix);
    }
    AddPose(matrix, folder.frames[i].number, path, head.number, &poses);
  }
  return poses;
}

NumberedPoses ReadMirroredPoses(const NumberedFolder& folder) {
  NumberedPoses poses;
  std::error_code error;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder.path, error)) {
    const fs::path& path = entry.path();
    if (path.extension() != ".freiburg" || path.stem().extension() != ".gt") {
      continue;
    }
    for (const StampedPose& pose : ReadTrajectory(path.string())) {
      // M T M with M = diag(1, -1, 1) has a proper rotation again.
      const Eigen::Quaterniond& q = pose.world_from_cam.rotation;
      const Eigen::Vector3d& t = pose.world_from_cam.translation;
      const auto place = static_cast<size_t>(std::lround(pose.timestamp)) - 1;
      if (place >= folder.frames.size()) continue;
      poses[folder.frames[place].number] =
          Rigid3d(Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()),
                  {t.x(), -t.y(), t.z()});
    }
    break;
  }
  return poses;
}

}  // namespace rgbd_pose
