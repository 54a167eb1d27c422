// Exports the results of a run, or a map, to the format of another tool.

#include <cstdio>

#include "apps/export/export_run.h"
#include "apps/shell/program.h"
#include "core/util/named_values.h"

namespace rgbd_pose {
namespace {

struct ExportSettings {
  std::string run, map, dataset, camera, to;
  ExportOptions options;
};

std::vector<Setting> Table(ExportSettings* settings) {
  constexpr std::string_view kInput = "Input";
  std::vector<Setting> table = {
      {"run", kInput, "results folder of rgbd_odometry or rgbd_slam",
       &settings->run},
      {"map", kInput,
       "folder of a map (rgbd_slam --save_map), in place of a run",
       &settings->map},
      {"dataset", kInput, "recording of the run, if it was moved",
       &settings->dataset},
      {"camera", kInput, "camera file of the run, if it was moved",
       &settings->camera},
      {"to", "Output", "format", &settings->to, NamesOf(ExportFormats())},
  };
  for (Setting& row : SettingTable(&settings->options)) {
    table.push_back(std::move(row));
  }
  return table;
}

ProgramInfo Info(ExportSettings* settings) {
  return {
      "rgbd_export",
      "exports the results of a run, or a map, to the formats of other tools.",
      "rgbd_export --run=runs/fr1_room --to=mesh --output=room.glb",
      {},
      {Table(settings)}};
}

int Main(const ExportSettings& settings, const ProgramInfo& /*info*/) {
  const auto& [folder, map, dataset, camera, to, options] = settings;
  RequireFlag("map or --run", folder + map);
  RequireFlag("to", to);
  if (!map.empty() && !(folder + dataset + camera).empty()) {
    throw InputError(
        "--map: a map has its own images; leave out --run, --dataset and "
        "--camera");
  }
  const FinishedRun run =
      map.empty() ? FinishedRun(folder, dataset, camera) : MapAsRun(map);
  std::fputs(ExportRun(run, to, options).summary.c_str(), stdout);
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
