#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/yaml_section.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/masks.h"
#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kFile[] = "transforms.json";
constexpr char kDepth[] = "depth_file_path";  // key of a frame

struct NerfstudioView {
  std::string color_path;
  std::string depth_path;
  Rigid3d world_from_cam;
};

// transforms.json: one camera, and a list of images with their poses.
class TransformsFile {
 public:
  explicit TransformsFile(const fs::path& folder)
      : folder_(folder),
        path_((folder / kFile).string()),
        file_(YamlSection::FromFile(path_)) {}

  // Nothing if each image has its own.
  std::optional<CameraSetup> ReadCamera() const {
    if (!file_.Has("fl_x")) return std::nullopt;
    const std::string model =
        file_.Word("camera_model", {"OPENCV", "PINHOLE", "OPENCV_FISHEYE"});
    // Its pixels are counted from their corners.
    constexpr double kPixelCentre = 0.5;
    Camera camera = {file_.Pixels("w"),
                     file_.Pixels("h"),
                     file_.Number("fl_x"),
                     file_.NumberOr("fl_y", file_.Number("fl_x")),
                     file_.Number("cx") - kPixelCentre,
                     file_.Number("cy") - kPixelCentre};
    if (model == "OPENCV_FISHEYE") camera.lens_model = LensModel::kEquidistant;
    if (model != "PINHOLE") {
      camera.k1 = file_.NumberOr("k1", 0.0);
      camera.k2 = file_.NumberOr("k2", 0.0);
      camera.k3 = file_.NumberOr("k3", 0.0);
      camera.k4 = file_.NumberOr("k4", 0.0);
      camera.p1 = file_.NumberOr("p1", 0.0);
      camera.p2 = file_.NumberOr("p2", 0.0);
    }
    RequireSound(camera.Check(), path_ + ": ");
    return CameraSetup(camera);
  }

  // Raw units per metre; rounded, as 0.001 has no exact inverse.
  double DepthScale() const {
    const char* const key = "depth_unit_scale_factor";
    const double metres = file_.NumberOr(key, 0.001);
    if (!(metres > 1e-6 && metres <= 1.0)) {
      file_.Fail(key, "must be the metres of a unit of depth, such as 0.001");
    }
    return std::round(1e6 / metres) / 1e6;
  }

  // The images with depth, in the order of the file. Counts the others.
  std::vector<NerfstudioView> ReadViews(int* unmatched_color) const {
    const YAML::Node frames = file_.node()["frames"];
    std::vector<NerfstudioView> views;
    for (size_t i = 0; frames && frames.IsSequence() && i < frames.size();
         ++i) {
      const YAML::Node frame = frames[i];
      if (!frame.IsMap() || !frame["file_path"].IsDefined()) continue;
      if (!frame[kDepth].IsDefined()) {
        ++*unmatched_color;
        continue;
      }
      views.push_back({(folder_ / frame["file_path"].Scalar()).string(),
                       (folder_ / frame[kDepth].Scalar()).string(),
                       PoseOf(frame)});
    }
    if (views.empty()) {
      throw InputError(path_ + ": none of its frames has a " + kDepth);
    }
    return views;
  }

 private:
  Rigid3d PoseOf(const YAML::Node& frame) const {
    const YAML::Node rows = frame["transform_matrix"];
    const int line = frame.Mark().line + 1;
    Eigen::Matrix<double, 3, 4> matrix;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        const bool has_number = rows && rows.IsSequence() && rows.size() >= 3 &&
                                rows[row].IsSequence() &&
                                rows[row].size() == 4 &&
                                rows[row][column].IsScalar();
        if (!has_number) {
          throw InputError(path_, line, "transform_matrix needs 4 x 4 numbers");
        }
        matrix(row, column) = ParseNumber(rows[row][column].Scalar(), path_,
                                          line, "transform_matrix");
      }
    }
    Eigen::Matrix3d rotation = matrix.leftCols<3>();
    rotation.rightCols<2>() *= -1.0;     // the axes of OpenGL: y up, z back
    constexpr double kTolerance = 0.05;  // of values with few digits
    const Eigen::Matrix3d product = rotation * rotation.transpose();
    if (!product.isIdentity(kTolerance) || !(rotation.determinant() > 0.0)) {
      throw InputError(path_, line, "transform_matrix: is not a pose");
    }
    return Rigid3d(Eigen::Quaterniond(rotation).normalized(), matrix.col(3));
  }

  fs::path folder_;
  std::string path_;
  YamlSection file_;
};

class Nerfstudio final : public Dataset {
 public:
  explicit Nerfstudio(const SourceOptions& options)
      : Nerfstudio(TransformsFile(options.path), options) {}

  int size() const override { return static_cast<int>(views_.size()); }
  double timestamp(int index) const override { return index / kNumberedRate; }
  Frame Read(int index) const override {
    const NerfstudioView& view = views_[index];
    return assembly_.Read({index, timestamp(index)}, view.color_path,
                          view.depth_path);
  }
  const RgbdCamera& camera() const override { return assembly_.camera(); }
  int unmatched_color() const override { return unmatched_color_; }

  Trajectory ground_truth() const override {
    Trajectory truth;
    for (int i = 0; i < size(); ++i) {
      truth.push_back({timestamp(i), views_[i].world_from_cam});
    }
    return truth;
  }

  std::vector<std::string> remarks() const override {
    std::vector<std::string> lines = {
        folder_ + Format(": has no times: the order of transforms.json and %g "
                         "frames per second are assumed",
                         kNumberedRate)};
    std::vector<std::string> colors;
    for (const NerfstudioView& view : views_) colors.push_back(view.color_path);
    const std::string masks = MaskRemark(colors);
    if (!masks.empty()) lines.push_back(masks);
    return lines;
  }

 private:
  Nerfstudio(const TransformsFile& file, const SourceOptions& options)
      : folder_(options.path),
        views_(file.ReadViews(&unmatched_color_)),
        assembly_(ChooseSetup(file, options), options.keep_color) {}

  static CameraSetup ChooseSetup(const TransformsFile& file,
                                 const SourceOptions& options) {
    std::optional<CameraSetup> own;
    if (!options.camera.has_value()) own = file.ReadCamera();
    CameraSetup setup = ChooseCamera(options, own);
    if (!setup.depth_scale) setup.depth_scale = file.DepthScale();
    return setup;
  }

  std::string folder_;
  int unmatched_color_ = 0;
  std::vector<NerfstudioView> views_;
  FrameAssembly assembly_;
};

}  // namespace

bool IsNerfstudio(const std::string& folder) {
  const fs::path path = fs::path(folder) / kFile;
  return IsFile(path) &&
         ReadTextFile(path.string()).find(kDepth) != std::string::npos;
}

std::unique_ptr<FrameSource> OpenNerfstudio(const SourceOptions& options) {
  return std::make_unique<Nerfstudio>(options);
}

}  // namespace rgbd_pose
