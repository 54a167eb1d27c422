// Exports the results of a run to the format of another tool.

#include <cstdio>
#include <filesystem>

#include "apps/export/export_format.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "frontend/settings/settings.h"

namespace rgbd_pose {
namespace {

// The default output is in the folder of the run. 0 threads mean one per core.
struct ExportSettings {
  std::string run, dataset, camera, to;
  ExportOptions options;
};

std::vector<Setting> Table(ExportSettings* settings) {
  constexpr std::string_view kInput = "Input", kOutput = "Output",
                             kPart = "What takes part";
  ExportOptions* options = &settings->options;
  options->threads = 0;
  return {
      {"run", kInput, "results folder of rgbd_odometry or rgbd_slam",
       &settings->run},
      {"dataset", kInput, "recording of the run, if it was moved",
       &settings->dataset},
      {"camera", kInput, "camera file of the run, if it was moved",
       &settings->camera},
      {"to", kOutput, "format", &settings->to, NamesOf(ExportFormats())},
      {"output", kOutput,
       "file or folder to write; empty: a default name in the folder of the "
       "run",
       &options->output},
      {"overwrite", kOutput, "replace a folder written by an earlier export",
       &options->overwrite},
      {"min_distance", kPart,
       "in formats with images a frame takes part if the camera has moved so "
       "far (m) since the last one that did, or turned by --min_angle",
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

ProgramInfo Info(ExportSettings* settings) {
  return {"rgbd_export",
          "exports the results of a run to the formats of other tools.",
          "rgbd_export --run=runs/fr1_room --to=mesh --output=room.glb",
          {},
          {Table(settings)}};
}

int Main(const ExportSettings& settings, const ProgramInfo& /*info*/) {
  const auto& [folder, dataset, camera, to, given] = settings;
  RequireFlag("run", folder);
  RequireFlag("to", to);
  const ExportFormat& format = RowOf(ExportFormats(), "format", to);
  const FinishedRun run(folder, dataset, camera);
  ExportOptions options = given;
  // VoxelCloud::Thin needs at least 8 points.
  if (options.max_points < 8) {
    throw InputError("--max_points must be 8 or more");
  }
  if (!(options.step.min_distance >= 0.0) ||
      !(options.step.min_angle_deg >= 0.0)) {
    throw InputError("--min_distance and --min_angle must not be negative");
  }
  options.threads = NumThreads(options.threads);
  if (options.output.empty()) {
    options.output =
        (std::filesystem::path(folder) / format.default_output).string();
  }
  std::fputs(format.write(run, options).c_str(), stdout);
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
