#include <algorithm>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/exr_file.h"
#include "frontend/files/image_file.h"
#include "frontend/files/yaml_section.h"
#include "frontend/frame/depth_resampling.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/scaled_images.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 640;         // of frames, px
constexpr double kDepthScale = 5000;  // raw units per metre that files become

struct Record3dFrame {
  double timestamp = 0.0;  // s
  std::string color_path;
  std::string depth_path;
};

// metadata.json: one entry of frameTimestamps and of poses for each image.
class Metadata {
 public:
  explicit Metadata(const fs::path& folder)
      : folder_(folder),
        path_((folder / "metadata.json").string()),
        file_(YamlSection::FromFile(path_)) {}

  // The camera of the colour images, whose size it states.
  Camera ReadCamera() const {
    const std::vector<double> k = file_.Numbers("K", {9});  // by columns
    const Camera camera = {
        file_.Pixels("w"), file_.Pixels("h"), k[0], k[4], k[6], k[7]};
    RequireSound(camera.Check(), path_ + ": K: ");
    return camera;
  }

  // Frames with both images, in order of time. Counts the colour images that
  // have no depth image.
  std::vector<Record3dFrame> ReadFrames(int* unmatched_color) const {
    const YAML::Node times = List("frameTimestamps");
    const double rate = file_.NumberOr("fps", 60.0);
    if (!(rate > 0.0)) file_.Fail("fps", "must be positive");
    std::vector<Record3dFrame> frames;
    // Images may be missing in the middle, too.
    for (size_t i = 0; i < times.size() || PathExists(File("rgb", i, ".jpg"));
         ++i) {
      Record3dFrame frame = {static_cast<double>(i) / rate,
                             File("rgb", i, ".jpg"), File("depth", i, ".exr")};
      if (i < times.size()) frame.timestamp = NumberAt(times[i]);
      if (!PathExists(frame.color_path)) continue;
      if (!PathExists(frame.depth_path)) {
        ++*unmatched_color;
        continue;
      }
      if (!frames.empty() && frame.timestamp <= frames.back().timestamp) {
        throw InputError(path_ + Format(": frameTimestamps: the time of image "
                                        "%zu is not after the previous one",
                                        i));
      }
      frames.push_back(frame);
    }
    if (frames.empty()) {
      throw InputError(folder_.string() +
                       ": has no pair rgb/0.jpg and depth/0.exr");
    }
    return frames;
  }

  // The path that ARKit estimated. Its camera axes are x right, y up, z back.
  Trajectory ReadPath(const std::vector<Record3dFrame>& frames) const {
    const YAML::Node poses = List("poses");
    const Rigid3d arkit_from_cam =
        Rigid3d::FromRotationVector({M_PI, 0.0, 0.0}, {0.0, 0.0, 0.0});
    Trajectory path;
    for (const Record3dFrame& frame : frames) {
      const int i =
          ParseWhole(fs::path(frame.color_path).stem().string()).value_or(0);
      if (i >= static_cast<int>(poses.size()) || poses[i].size() != 7) continue;
      double p[7];
      for (int k = 0; k < 7; ++k) p[k] = NumberAt(poses[i][k]);
      const Eigen::Quaterniond turn(p[3], p[0], p[1], p[2]);
      if (!(std::abs(turn.norm() - 1.0) < 1e-3)) continue;
      path.push_back(
          {frame.timestamp,
           Rigid3d(turn.normalized(), {p[4], p[5], p[6]}) * arkit_from_cam});
    }
    return path;
  }

 private:
  std::string File(const char* folder, size_t i, const char* type) const {
    return (folder_ / folder / (std::to_string(i) + type)).string();
  }

  // The list of a key; an empty one if there is none.
  YAML::Node List(const std::string& key) const {
    if (!file_.Has(key) || !file_.node()[key].IsSequence()) return {};
    return file_.node()[key];
  }

  double NumberAt(const YAML::Node& node) const {
    return ParseNumber(node.Scalar(), path_, node.Mark().line + 1, "number");
  }

  fs::path folder_;
  std::string path_;
  YamlSection file_;
};

class Record3d final : public Dataset {
 public:
  explicit Record3d(const SourceOptions& options)
      : Record3d(Metadata(options.path), options) {}

  int size() const override { return static_cast<int>(frames_.size()); }
  double timestamp(int index) const override {
    return frames_[index].timestamp;
  }
  const RgbdCamera& camera() const override { return assembly_.camera(); }
  Trajectory ground_truth() const override { return path_; }
  int unmatched_color() const override { return unmatched_color_; }

  Frame Read(int index) const override {
    const Record3dFrame& files = frames_[index];
    cv::Mat image;
    ReadGrayImageFile(files.color_path, &image);
    if (image.cols != full_.width || image.rows != full_.height) {
      throw InputError(files.color_path +
                       ": has not the size w x h of metadata.json");
    }
    const cv::Size size(camera_.width, camera_.height);
    cv::Mat color, gray;
    cv::resize(image, color, size, 0.0, 0.0, cv::INTER_AREA);
    cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
    const cv::Mat depth = ReadExrDepth(files.depth_path, kDepthScale);
    return assembly_.Make(
        {index, files.timestamp}, {gray, files.color_path}, color,
        {ResampleDepth(depth, size,
                       PixelMap(camera_, ScaledTo(full_, depth.size()))),
         files.depth_path});
  }

 private:
  Record3d(const Metadata& metadata, const SourceOptions& options)
      : frames_(metadata.ReadFrames(&unmatched_color_)),
        path_(metadata.ReadPath(frames_)),
        full_(metadata.ReadCamera()),
        camera_(ScaledTo(full_, SizeOf(options))),
        assembly_(MakeAssembly(options)) {}

  // The size of frames: that of a given camera, or at most kMaxSide px.
  cv::Size SizeOf(const SourceOptions& options) const {
    if (options.camera.has_value()) {
      return {options.camera->camera.width, options.camera->camera.height};
    }
    const int side = std::max(full_.width, full_.height);
    const double scale = std::min(1.0, static_cast<double>(kMaxSide) / side);
    return {cvRound(scale * full_.width), cvRound(scale * full_.height)};
  }

  FrameAssembly MakeAssembly(const SourceOptions& options) const {
    CameraSetup own(camera_);
    own.depth_scale = kDepthScale;
    return FrameAssembly(ChooseCamera(options, own), options.keep_color);
  }

  int unmatched_color_ = 0;
  std::vector<Record3dFrame> frames_;
  Trajectory path_;
  Camera full_;    // of the colour images as they are
  Camera camera_;  // of frames
  FrameAssembly assembly_;
};

}  // namespace

std::unique_ptr<FrameSource> OpenRecord3d(const SourceOptions& options) {
  return std::make_unique<Record3d>(options);
}

}  // namespace rgbd_pose
