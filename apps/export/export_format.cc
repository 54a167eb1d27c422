#include "apps/export/export_format.h"

#include <opencv2/imgcodecs.hpp>
#include <system_error>

#include "core/util/format.h"
#include "core/util/units.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/undistorter.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// Colour images are large, and strong compression would take most of the time.
const std::vector<int> kQuick = {cv::IMWRITE_PNG_COMPRESSION, 1};

cv::Mat InMillimetres(const Frame& frame) {
  cv::Mat depth = frame.depth.clone();
  depth.setTo(0, frame.depth == Frame::kNoDepth);
  depth.convertTo(depth, CV_16UC1, kMillimetresPerMetre / frame.depth_scale);
  return depth;
}

[[noreturn]] void FailToWrite(const fs::path& path,
                              const std::error_code& error) {
  throw InputError("--output: " + path.string() + " cannot be created (" +
                   error.message() + ")");
}

}  // namespace

const std::vector<ExportFormat>& ExportFormats() {
  static const std::vector<ExportFormat> formats = {
      {"mesh", "mesh.ply", ExportMesh},
      {"cloud", "cloud.ply", ExportCloud},
      {"colmap", "colmap", ExportColmap},
      {"nerfstudio", "nerfstudio", ExportNerfstudio},
      {"mcap", "run.mcap", ExportMcap},
      {"kitti", "kitti", ExportKitti},
      {"tum", "trajectory_tum.txt", ExportTum},
      {"g2o", "poses.g2o", ExportG2o},
  };
  return formats;
}

ExportedViews ReadImages(const FinishedRun& run, const ExportOptions& options,
                         const OnView& on_image) {
  const std::unique_ptr<FrameSource> source = OpenRecording(run);
  const Camera& camera = source->camera().camera;
  const Undistorter undistorter(camera);
  CloudFusion cloud(FusionOf<FusionOptions>(camera, run, options));
  const std::vector<int> views =
      ReadViews(run, options, source.get(), [&](const Frame& frame, int view) {
        cloud.Add(frame, run.trajectory[view].world_from_cam);
        on_image(options.undistort ? undistorter.Undistort(frame) : frame,
                 view);
      });
  return {options.undistort ? undistorter.camera() : camera, views,
          cloud.cloud().Thin(options.max_points)};
}

std::string ImageName(const FinishedRun& run, int view) {
  return Format("%06d.png", run.frames[view]);
}

ExportedViews WriteViewImages(const FinishedRun& run,
                              const ExportOptions& options,
                              const fs::path& color_folder,
                              const fs::path& depth_folder) {
  return ReadImages(run, options, [&](const Frame& frame, int view) {
    const std::string name = ImageName(run, view);
    WritePngFile(color_folder / name, frame.color, kQuick);
    if (!depth_folder.empty()) {
      WritePngFile(depth_folder / name, InMillimetres(frame));
    }
  });
}

OutputFolder::OutputFolder(const std::string& path,
                           const std::set<std::string>& entries, bool overwrite)
    : path_(fs::weakly_canonical(path)) {
  if (!path_.has_filename()) path_ = path_.parent_path();
  staging_dir_ = path_.string() + ".partial";
  std::error_code error;
  if (fs::exists(path_) && !fs::is_directory(path_)) {
    throw InputError("--output: " + path + " is a file; a folder is needed");
  }
  if (!overwrite && fs::is_directory(path_) && !fs::is_empty(path_)) {
    throw InputError("--output: " + path +
                     " is not empty; use --overwrite to replace it");
  }
  for (const auto& entry : fs::directory_iterator(path_, error)) {
    const std::string name = entry.path().filename();
    if (entries.count(name) == 0) {
      throw InputError("--output: " + path + " contains other files, such as " +
                       name + "; choose another folder");
    }
  }
  fs::remove_all(staging_dir_, error);  // left by a killed export
  fs::create_directories(staging_dir_, error);
  if (error) FailToWrite(path, error);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(staging_dir_, ignored);
}

fs::path OutputFolder::MakeFolder(const std::string& name) const {
  std::error_code error;
  fs::create_directories(staging_dir_ / name, error);
  if (error) FailToWrite(staging_dir_ / name, error);
  return staging_dir_ / name;
}

void OutputFolder::Publish() {
  std::error_code error;
  fs::remove_all(path_, error);
  fs::rename(staging_dir_, path_, error);
  if (error) FailToWrite(path_, error);
}

}  // namespace rgbd_pose
