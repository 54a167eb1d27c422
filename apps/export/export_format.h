#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/export/finished_run.h"
#include "apps/results/run_output.h"
#include "core/util/input_error.h"
#include "frontend/frame/undistorter.h"
#include "frontend/fusion/fusion_options.h"

namespace rgbd_pose {

// What users say of an export; each format takes what concerns it.
struct ExportOptions {
  std::string output;      // a file or a folder, as the format has it
  bool overwrite = false;  // a folder that is there

  // Which frames take part where images do.
  MotionFilter step;

  bool undistort = false;   // images, as of a pinhole camera
  double voxel = 0.01;      // of meshes and clouds, m
  double max_depth = 0.0;   // for these, m; 0: as the run, meshes 4 m
  int max_points = 200000;  // of clouds that come along with images
  int threads = 1;          // that read images ahead
};

// The upper left pixel of COLMAP and nerfstudio has its centre at (0.5, 0.5),
// ours at (0, 0).
constexpr double kPixelCentre = 0.5;

// A form that a run can be given to other tools in. To add one, write a file
// with such a function and give it a row of the table in export_format.cc.
struct ExportFormat {
  const char* name;            // as users write it
  const char* default_output;  // file, or folder, in that of the run
  // Writes it, as a whole or not at all; returns what the program prints.
  // Throws InputError.
  std::string (*write)(const FinishedRun& run, const ExportOptions& options);
};

// Poses alone.
std::string ExportTum(const FinishedRun& run, const ExportOptions& options);
std::string ExportKitti(const FinishedRun& run, const ExportOptions& options);
std::string ExportG2o(const FinishedRun& run, const ExportOptions& options);

// Images with poses.
std::string ExportColmap(const FinishedRun& run, const ExportOptions& options);
std::string ExportNerfstudio(const FinishedRun& run,
                             const ExportOptions& options);

// What was seen.
std::string ExportCloud(const FinishedRun& run, const ExportOptions& options);
std::string ExportMesh(const FinishedRun& run, const ExportOptions& options);

// Throws InputError if SaveMesh could not read the frames again, as those of a
// camera: to be said before the run rather than after it.
void RequireMeshFrames(const RunOutputSettings& settings,
                       const std::string& dataset);

// The mesh that a run which has just ended was asked for, if it was; returns
// what the program prints.
std::string SaveMesh(const RunOutputSettings& settings, int threads);

// The names of all formats.
std::vector<std::string> ExportFormatNames();

// The format of that name. Throws InputError that lists the names.
const ExportFormat& FindExportFormat(const std::string& name);

// The images of some views as files of their own, for tools that want a folder
// of images, whatever the recording was; and what is seen in them.
struct ExportedViews {
  Camera camera;  // of the images
  std::vector<std::string> names;
  std::vector<Rigid3d> world_from_cam;
  std::vector<ColoredPoint> cloud;
};

// Writes them, named by their frames. Depth images, if there is a folder for
// them, are in whole millimetres, 0 where there is none.
ExportedViews WriteViewImages(const FinishedRun& run,
                              const ExportOptions& options,
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
