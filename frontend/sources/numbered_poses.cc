#include <array>
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

// A matrix, word by word. In a lost frame its values are infinite or NaN.
class MatrixWords {
 public:
  void Add(const std::string& word, const std::string& path, int line) {
    const bool is_lost =
        word == "-inf" || word == "inf" || word == "nan" || word == "-nan";
    is_lost_ |= is_lost;
    values_[count_++] = is_lost ? 0.0 : ParseNumber(word, path, line, "pose");
  }
  bool IsWhole() const { return count_ == 16; }

  // Stores the pose unless the frame is lost, and starts the next matrix.
  void Finish(int number, const std::string& path, int line,
              NumberedPoses* poses) {
    const auto& m = values_;
    if (!is_lost_) {
      Eigen::Matrix3d rotation;
      rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
      // Tolerates values with few digits.
      const double error =
          (rotation * rotation.transpose() - Eigen::Matrix3d::Identity())
              .norm();
      if (!(error < 0.05) || !(rotation.determinant() > 0.0)) {
        throw InputError(path, line,
                         "not a pose: the upper left 3 x 3 is not a rotation");
      }
      (*poses)[number] =
          Rigid3d(Eigen::Quaterniond(rotation), {m[3], m[7], m[11]});
    }
    *this = MatrixWords();
  }

 private:
  std::array<double, 16> values_ = {};
  int count_ = 0;
  bool is_lost_ = false;
};

// Reads 16 numbers, in any distribution over the lines.
void ReadMatrixFile(const std::string& path, int number, NumberedPoses* poses) {
  MatrixWords matrix;
  for (const TextLine& line : ReadTextTable(path)) {
    for (const std::string& word : line.words) {
      if (matrix.IsWhole()) {
        throw InputError(path, line.number, "has more than 4 x 4 numbers");
      }
      matrix.Add(word, path, line.number);
    }
  }
  if (!matrix.IsWhole()) throw InputError(path + ": needs 4 rows of 4 numbers");
  matrix.Finish(number, path, 1, poses);
}

}  // namespace

NumberedPoses ReadFramePoses(const std::string& folder,
                             const std::vector<int>& numbers) {
  NumberedPoses poses;
  for (const int number : numbers) {
    const fs::path path =
        fs::path(folder) / Format("frame-%06d.pose.txt", number);
    if (PathExists(path)) ReadMatrixFile(path.string(), number, &poses);
  }
  return poses;
}

NumberedPoses ReadPoseFolder(const std::string& folder,
                             const std::vector<int>& numbers) {
  NumberedPoses poses;
  for (const int number : numbers) {
    const fs::path path =
        fs::path(folder) / "pose" / (std::to_string(number) + ".txt");
    if (PathExists(path)) ReadMatrixFile(path.string(), number, &poses);
  }
  return poses;
}

NumberedPoses ReadPoseLines(const std::string& folder,
                            const std::vector<int>& numbers) {
  const fs::path file = fs::path(folder) / "traj.txt";
  NumberedPoses poses;
  if (!PathExists(file)) return poses;
  const std::string path = file.string();
  size_t i = 0;
  for (const TextLine& line : ReadTextTable(path)) {
    if (i == numbers.size()) break;  // the rest are poses of missing frames
    if (line.words.size() != 16) {
      throw InputError(path, line.number,
                       "needs the 16 numbers of a 4 x 4 matrix, has " +
                           std::to_string(line.words.size()));
    }
    MatrixWords matrix;
    for (const std::string& word : line.words) {
      matrix.Add(word, path, line.number);
    }
    matrix.Finish(numbers[i++], path, line.number, &poses);
  }
  return poses;
}

NumberedPoses ReadPoseLog(const std::string& folder,
                          const std::vector<int>& numbers) {
  const fs::path file = fs::path(folder) / "trajectory.log";
  NumberedPoses poses;
  if (!PathExists(file)) return poses;
  const std::string path = file.string();
  const std::vector<TextLine> lines = ReadTextTable(path);
  for (size_t i = 0; i < numbers.size() && 5 * i < lines.size(); ++i) {
    const TextLine& head = lines[5 * i];
    if (head.words.size() != 3 || 5 * i + 4 >= lines.size()) {
      throw InputError(path, head.number,
                       "needs three integers and then 4 rows of 4 numbers");
    }
    MatrixWords matrix;
    for (int row = 1; row <= 4; ++row) {
      const TextLine& line = lines[5 * i + row];
      if (line.words.size() != 4) {
        throw InputError(path, line.number, "needs a row of 4 numbers");
      }
      for (const std::string& word : line.words) {
        matrix.Add(word, path, line.number);
      }
    }
    matrix.Finish(numbers[i], path, head.number, &poses);
  }
  return poses;
}

NumberedPoses ReadMirroredPoses(const std::string& folder,
                                const std::vector<int>& numbers) {
  NumberedPoses poses;
  std::error_code error;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    const std::string end = ".gt.freiburg";
    if (path.size() < end.size() ||
        path.compare(path.size() - end.size(), end.size(), end) != 0) {
      continue;
    }
    for (const StampedPose& pose : ReadTrajectory(path)) {
      // M T M with M = diag(1, -1, 1) has a proper rotation again.
      const Eigen::Quaterniond& q = pose.world_from_cam.rotation;
      const Eigen::Vector3d& t = pose.world_from_cam.translation;
      const auto place = static_cast<size_t>(std::lround(pose.timestamp)) - 1;
      if (place >= numbers.size()) continue;
      poses[numbers[place]] =
          Rigid3d(Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()),
                  {t.x(), -t.y(), t.z()});
    }
    break;
  }
  return poses;
}

}  // namespace rgbd_pose
