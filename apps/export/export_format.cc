#include "apps/export/export_format.h"

#include <opencv2/imgcodecs.hpp>

#include "core/util/format.h"
#include "core/util/named_values.h"
#include "core/util/units.h"
#include "frontend/files/image_file.h"
#include "frontend/fusion/cloud_fusion.h"

namespace rgbd_pose {
namespace {

constexpr ExportFormat kFormats[] = {
    {"mesh", "mesh.ply", ExportMesh},
    {"cloud", "cloud.ply", ExportCloud},
    {"colmap", "colmap", ExportColmap},
    {"nerfstudio", "nerfstudio", ExportNerfstudio},
    {"mcap", "run.mcap", ExportMcap},
    {"kitti", "kitti", ExportKitti},
    {"tum", "trajectory_tum.txt", ExportTum},
    {"g2o", "poses.g2o", ExportG2o},
};

// Colour images are large, and strong compression would take most of the time.
const std::vector<int> kQuick = {cv::IMWRITE_PNG_COMPRESSION, 1};

cv::Mat InMillimetres(const Frame& frame) {
  cv::Mat depth = frame.depth.clone();
  depth.setTo(0, frame.depth == Frame::kNoDepth);
  depth.convertTo(depth, CV_16UC1, kMillimetresPerMetre / frame.depth_scale);
  return depth;
}

}  // namespace

std::vector<std::string> ExportFormatNames() { return NamesOf(kFormats); }

const ExportFormat& FindExportFormat(const std::string& name) {
  return RowOf(kFormats, "format", name);
}

ExportedViews WriteViewImages(const FinishedRun& run,
                              const ExportOptions& options,
                              const std::filesystem::path& color_folder,
                              const std::filesystem::path& depth_folder) {
  ExportedViews images;
  RunRecording recording(run);
  const Camera& camera = recording.camera().camera;
  const Undistorter undistorter(camera);
  images.camera = options.undistort ? undistorter.camera() : camera;
  CloudFusion cloud(FusionOf<FusionOptions>(camera, run, options));
  const std::vector<int> views = run.PickViews(options.step);
  recording.ReadViews(
      views, options.threads,
      [&](const Frame& frame, const Rigid3d& world_from_cam) {
        const int number = run.frames()[views[images.names.size()]];
        const std::string name = Format("%06d.png", number);
        cloud.Add(frame, world_from_cam);
        const Frame shown =
            options.undistort ? undistorter.Undistort(frame) : frame;
        WritePngFile(color_folder / name, shown.color, kQuick);
        if (!depth_folder.empty()) {
          WritePngFile(depth_folder / name, InMillimetres(shown));
        }
        images.names.push_back(name);
        images.world_from_cam.push_back(world_from_cam);
      });
  images.cloud = cloud.cloud().Thin(options.max_points);
  return images;
}

}  // namespace rgbd_pose
