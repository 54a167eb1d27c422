#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/export/export_format.h"
#include "core/util/input_error.h"
#include "frontend/frame/undistorter.h"
#include "frontend/fusion/cloud_fusion.h"

namespace rgbd_pose {

// The images of some views as files of their own, for tools that want a folder
// of images, whatever the recording was; and what is seen in them.
struct ViewImages {
  Camera camera;  // of the images
  std::vector<std::string> names;
  std::vector<Rigid3d> world_from_cam;
  std::vector<ColoredPoint> cloud;
};

// Writes them, named by their frames. Depth images, if there is a folder for
// them, are in whole millimetres, 0 where there is none.
ViewImages WriteViewImages(const FinishedRun& run, const ExportOptions& options,
                           const std::filesystem::path& color_folder,
                           const std::filesystem::path& depth_folder = {});

// How the views are fused, to a cloud or a mesh. Throws InputError for options
// that make no sense.
template <typename Fusion>
Fusion FusionOf(const Camera& camera, const FinishedRun& run,
                const ExportOptions& options, Fusion fusion = {}) {
  fusion.camera = camera;
  fusion.voxel_size = options.voxel;
  fusion.depth = run.depth();
  if (options.max_depth > 0.0) fusion.depth.max_depth = options.max_depth;
  const std::string problem = fusion.Check();
  if (!problem.empty()) throw InputError("--voxel or --max_depth: " + problem);
  return fusion;
}

}  // namespace rgbd_pose
