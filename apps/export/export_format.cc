#include "apps/export/export_format.h"

#include <algorithm>
#include <system_error>

#include "core/util/format.h"
#include "core/util/text_file.h"
#include "core/util/units.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/undistorter.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void FailToWrite(const fs::path& path,
                              const std::error_code& error) {
  throw InputError("--output: " + path.string() + " cannot be created (" +
                   error.message() + ")");
}

// The file in an exported folder that has the names of all its other files, one
// in a line.
constexpr char kContent[] = ".exported_files";

// All files in a folder and below, relative to it.
std::vector<std::string> FilesIn(const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::error_code error;  // a link to itself is no folder
    if (entry.is_directory(error)) continue;
    files.push_back(entry.path().lexically_relative(folder).string());
  }
  std::sort(files.begin(), files.end());
  return files;
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
  CloudFusion cloud(FusionOf<FusionOptions>(source->camera(), run, options));
  const std::vector<int> views =
      ReadViews(run, options, source.get(), [&](const Frame& frame, int view) {
        cloud.Add(frame, run.trajectory[view].world_from_cam);
        on_image(options.undistort ? undistorter.Undistort(frame) : frame,
                 view);
      });
  return {options.undistort ? undistorter.camera() : camera, views,
          cloud.cloud().Thin(options.max_points)};
}

cv::Mat DepthInMillimetres(const Frame& frame) {
  const double per_unit = kMillimetresPerMetre / frame.depth_scale;
  cv::Mat depth = frame.depth.clone();
  // Also 0 is what would not fit, beyond 65.5 m.
  depth.setTo(0, frame.depth >= Frame::kNoDepth / std::max(1.0, per_unit));
  depth.convertTo(depth, CV_16UC1, per_unit);
  return depth;
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
    WritePngFile(color_folder / name, frame.color);
    if (!depth_folder.empty()) {
      WritePngFile(depth_folder / name, DepthInMillimetres(frame));
    }
  });
}

OutputFolder::OutputFolder(const std::string& path, bool overwrite)
    : path_((fs::weakly_canonical(path) / "").parent_path()),
      replaced_dir_(path_.string() + ".replaced_by_export"),
      staging_(path_.string() + ".rgbd_export.partial", "--output: " + path) {
  std::error_code error;
  // A killed export leaves the old folder under this name: it returns unless
  // there is a new one.
  fs::rename(replaced_dir_, path_, error);
  fs::remove_all(replaced_dir_, error);
  if (fs::exists(path_) && !fs::is_directory(path_)) {
    throw InputError("--output: " + path + " is a file; a folder is needed");
  }
  if (!fs::exists(path_)) return;
  if (!overwrite && !fs::is_empty(path_)) {
    throw InputError("--output: " + path +
                     " is not empty; use --overwrite to replace it");
  }
  std::vector<std::string> ours;  // sorted
  if (IsFile(path_ / kContent)) {
    ours = SplitText(ReadTextFile((path_ / kContent).string()), '\n');
  }
  for (const std::string& name : FilesIn(path_)) {
    if (name == kContent || std::binary_search(ours.begin(), ours.end(), name))
      continue;
    throw InputError("--output: " + path + " contains other files, such as " +
                     name + "; choose another folder");
  }
}

fs::path OutputFolder::MakeFolder(const std::string& name) const {
  std::error_code error;
  fs::create_directories(staging_dir() / name, error);
  if (error) FailToWrite(staging_dir() / name, error);
  return staging_dir() / name;
}

void OutputFolder::Publish() {
  WriteFileAtomically((staging_dir() / kContent).string(),
                      Join(FilesIn(staging_dir()), "\n"));
  std::error_code error;
  if (fs::exists(path_)) fs::rename(path_, replaced_dir_, error);
  if (!error) fs::rename(staging_dir(), path_, error);
  if (error) FailToWrite(path_, error);
  fs::remove_all(replaced_dir_, error);
}

}  // namespace rgbd_pose
