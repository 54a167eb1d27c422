#include "apps/export/export_format.h"

#include <opencv2/imgcodecs.hpp>

#include "core/util/format.h"
#include "core/util/units.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/undistorter.h"

namespace rgbd_pose {
namespace {

// Colour images are large, and strong compression would take most of the time.
const std::vector<int> kQuick = {cv::IMWRITE_PNG_COMPRESSION, 1};

cv::Mat InMillimetres(const Frame& frame) {
  cv::Mat depth = frame.depth.clone();
  depth.setTo(0, frame.depth == Frame::kNoDepth);
  depth.convertTo(depth, CV_16UC1, kMillimetresPerMetre / frame.depth_scale);
  return depth;
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
                              const std::filesystem::path& color_folder,
                              const std::filesystem::path& depth_folder) {
  return ReadImages(run, options, [&](const Frame& frame, int view) {
    const std::string name = ImageName(run, view);
    WritePngFile(color_folder / name, frame.color, kQuick);
    if (!depth_folder.empty()) {
      WritePngFile(depth_folder / name, InMillimetres(frame));
    }
  });
}

}  // namespace rgbd_pose
