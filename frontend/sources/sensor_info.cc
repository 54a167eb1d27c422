#include "frontend/sources/sensor_info.h"

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

// A text file with a line "key = number number ..." for each key.
class InfoFile {
 public:
  explicit InfoFile(const std::string& path)
      : path_(path), lines_(ReadTextTable(path)) {}

  const std::string& path() const { return path_; }

  bool Has(const std::string& key) const { return Find(key) != nullptr; }

  double Number(const std::string& key) const { return Numbers(key, 1)[0]; }

  Matrix4 Matrix(const std::string& key) const {
    return Matrix4(Numbers(key, 16).data());
  }

  // A camera: its size is in `image`Width, its matrix in `lens`Intrinsic.
  Camera ReadCamera(const std::string& image, const std::string& lens) const {
    const Matrix4 k = Matrix(lens + "Intrinsic");
    const Camera camera = {Pixels(image + "Width"),
                           Pixels(image + "Height"),
                           k(0, 0),
                           k(1, 1),
                           k(0, 2),
                           k(1, 2)};
    RequireSound(camera.Check(), path_ + ": " + lens + ": ");
    return camera;
  }

 private:
  int Pixels(const std::string& key) const {
    constexpr double kMost = 1 << 16;
    const double number = Number(key);
    if (!(number >= 1.0 && number <= kMost)) {
      throw InputError(path_, Find(key)->number,
                       key + " must be a number of pixels");
    }
    return static_cast<int>(number);
  }

  // The line of a key; null: there is none.
  const TextLine* Find(const std::string& key) const {
    for (const TextLine& line : lines_) {
      if (line.words.front() == key) return &line;
    }
    return nullptr;
  }

  std::vector<double> Numbers(const std::string& key, size_t count) const {
    const TextLine* line = Find(key);
    if (line == nullptr) {
      throw InputError(path_ + ": has no " + key +
                       "; give a calibration file (camera)");
    }
    constexpr size_t kFirst = 2;  // after the key and "="
    if (line->words.size() != kFirst + count) {
      throw InputError(path_, line->number,
                       Format("%s needs numbers: %zu", key.c_str(), count));
    }
    std::vector<double> numbers;
    for (size_t i = kFirst; i < line->words.size(); ++i) {
      numbers.push_back(ParseNumber(line->words[i], path_, line->number, key));
    }
    return numbers;
  }

  std::string path_;
  std::vector<TextLine> lines_;
};

// Any other matrix has an undocumented convention, and is refused.
void RequireIdentity(const InfoFile& file, const std::string& key) {
  if (!file.Has(key) || file.Matrix(key).isIdentity(1e-6)) return;
  throw InputError(file.path() + ": " + key +
                   " must be the identity; give both cameras as a Kalibr file "
                   "(camera, depth_camera)");
}

}  // namespace

std::optional<CameraSetup> ReadSensorInfo(const fs::path& folder) {
  for (const char* name : {"info.txt", "_info.txt", "../info.txt"}) {
    if (!PathExists(folder / name)) continue;
    const InfoFile file((folder / name).string());
    CameraSetup setup(file.ReadCamera("m_color", "m_calibrationColor"));
    setup.depth_scale = file.Number("m_depthShift");
    setup.depth_camera = DepthCamera{
        file.ReadCamera("m_depth", "m_calibrationDepth"), Rigid3d()};
    RequireIdentity(file, "m_calibrationColorExtrinsic");
    RequireIdentity(file, "m_calibrationDepthExtrinsic");
    return setup;
  }
  return std::nullopt;
}

}  // namespace rgbd_pose
