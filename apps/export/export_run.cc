#include "apps/export/export_run.h"

#include <filesystem>
#include <string_view>
#include <utility>

#include "apps/shell/program.h"
#include "core/util/input_error.h"

namespace rgbd_pose {

std::vector<Setting> SettingTable(ExportOptions* options) {
  constexpr std::string_view kOutput = "Output", kPart = "What takes part";
  options->threads = 0;
  return {
      {"output", kOutput,
       "file or folder to write; empty: a default name in the folder of the "
       "run",
       &options->output},
      {"overwrite", kOutput, "replace a folder written by an earlier export",
       &options->overwrite},
      {"min_distance", kPart,
       "in formats with images a frame takes part if the camera has moved so "
       "far (m) since the last one that did, or turned by min_angle",
       &options->step.min_distance},
      {"min_angle", kPart,
       "in formats with images a frame takes part if the camera has turned so "
       "far (degrees) since the last one that did; 0: every frame",
       &options->step.min_angle_deg},
      {"undistort", kPart,
       "images of an ideal camera, without distortion, for tools that know no "
       "other",
       &options->undistort},
      {"voxel", kPart, "side of the cubes (m) of meshes and clouds",
       &options->voxel},
      {"max_depth", kPart,
       "depths beyond (m) are left out of meshes and clouds; 0: those that the "
       "run left out, and for meshes beyond 4 m",
       &options->max_depth},
      {"max_points", kPart,
       "points, at most, of the cloud that comes along with images",
       &options->max_points},
      {"threads", "Run",
       "threads that read images ahead; 0: one for each core; the result does "
       "not depend on it",
       &options->threads},
  };
}

WrittenExport ExportRun(const FinishedRun& run, const std::string& format,
                        ExportOptions options) {
  const ExportFormat row = RowOf(ExportFormats(), "format", format);
  // VoxelCloud::Thin needs at least 8 points.
  if (options.max_points < 8) {
    throw InputError("--max_points must be 8 or more");
  }
  if (!(options.step.min_distance >= 0.0) ||
      !(options.step.min_angle_deg >= 0.0)) {
    throw InputError("--min_distance and --min_angle must not be negative");
  }
  if (!(options.max_depth >= 0.0)) {
    throw InputError("--max_depth must not be negative (0: that of the run)");
  }
  options.threads = NumThreads(options.threads);
  if (options.output.empty() && run.folder.empty()) {
    throw InputError("--output is needed; there is no folder of a run");
  }
  if (options.output.empty()) {
    options.output =
        (std::filesystem::path(run.folder) / row.default_output).string();
  }
  RequireOutside("output", options.output, run.sequence.dataset,
                 run.map == nullptr ? "recording" : "map");
  std::string summary = row.write(run, options);
  return {options.output, std::move(summary)};
}

}  // namespace rgbd_pose
