// Exports of runs and paths: meshes, clouds, formats of other tools.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "apps/export/export_run.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "apps/python/recording.h"
#include "apps/python/released_gil.h"
#include "apps/python/setting_arguments.h"
#include "core/util/named_values.h"

namespace py = pybind11;

namespace rgbd_pose {

static void EachField(PickledBytes* bytes, WrittenExport& written) {
  (*bytes)(written.path, written.summary);
}

namespace {

// The rows that Python has as keywords; `output` is an argument of its own.
std::vector<Setting> ExportTable(ExportOptions* options) {
  return WithoutRow("output", SettingTable(options));
}

// The options of a call. The export, which has no GIL, can be interrupted.
ExportOptions OptionsFrom(const char* function, const py::object& output,
                          const py::kwargs& keywords) {
  ExportOptions options;
  SetFromKeywords(function, keywords, ExportTable(&options));
  if (!output.is_none()) options.output = PathFrom(output);
  options.on_frame = ThrowIfInterrupted;
  return options;
}

WrittenExport ExportFolder(const py::object& run, const std::string& to,
                           const py::object& output, const py::object& dataset,
                           const py::object& camera,
                           const py::kwargs& keywords) {
  const ExportOptions options = OptionsFrom("export_run", output, keywords);
  const std::string folder = PathFrom(run);
  const std::string recording = dataset.is_none() ? "" : PathFrom(dataset);
  const std::string file = camera.is_none() ? "" : PathFrom(camera);
  const ReleasedGil no_gil;
  return ExportRun(FinishedRun(folder, recording, file), to, options);
}

WrittenExport ExportPath(const Recording& recording,
                         const py::object& trajectory, const std::string& to,
                         const py::object& output, const py::kwargs& keywords) {
  const ExportOptions options = OptionsFrom("export_path", output, keywords);
  Trajectory path = TrajectoryFrom(trajectory, "trajectory");
  const auto open = [open = recording.open()] {
    return open(/*keep_color=*/true);
  };
  const ReleasedGil no_gil;
  FinishedRun run(std::move(path), open);
  run.sequence.dataset = recording.path();  // in which nothing may be written
  return ExportRun(run, to, options);
}

WrittenExport ExportMap(const py::object& map, const std::string& to,
                        const py::object& output, const py::kwargs& keywords) {
  const ExportOptions options = OptionsFrom("export_map", output, keywords);
  const std::string folder = PathFrom(map);
  const ReleasedGil no_gil;
  return ExportRun(MapAsRun(folder), to, options);
}

void BindWritten(py::module_* module) {
  py::class_<WrittenExport> written(*module, "Export",
                                    "What an export has written. It can be "
                                    "given to open() and pathlib.Path() "
                                    "as it is.");
  const auto property = PropertiesOf(&written);
  const auto path = [](const WrittenExport& self) { return PathTo(self.path); };
  property("path", path, "file or folder");
  property(
      "summary", [](const WrittenExport& self) { return TextOf(self.summary); },
      "what is in it, as text: the numbers of points, triangles, poses or "
      "images");
  written.def("__fspath__", path);
  written.def("__repr__", [path](const WrittenExport& self) {
    return "Export(" + py::repr(path(self)).cast<std::string>() + ")";
  });
  written.def(Pickled<WrittenExport>());
}

}  // namespace

void BindExport(py::module_* module) {
  BindWritten(module);
  module->def(
      "export_formats", [] { return NamesOf(ExportFormats()); },
      "Names of all formats for export_run, export_path and export_map.");
  ExportOptions defaults;
  const std::vector<Setting> table = ExportTable(&defaults);
  DefineWithSettings(module, "export_run", &ExportFolder, table, R"(
Writes a run of rgbd_odometry or rgbd_slam for another tool, as rgbd_export does:
its poses, or a mesh, a cloud or images with poses. All or nothing is written.
The GIL is released.

run: the folder of the results of the run.
to: the format, one of export_formats(); "mesh" by the ending of output (.ply or
    .glb).
output: file or folder to write; None: a default name in the folder of the run.
dataset, camera: the recording and the camera file of the run, if they were
    moved.

Returns an Export. Raises InputError for a folder without a run, for invalid
arguments and if something cannot be read or written.)",
                     py::arg("run"), py::arg("to"),
                     py::arg("output") = py::none(), py::kw_only(),
                     py::arg("dataset") = py::none(),
                     py::arg("camera") = py::none());
  DefineWithSettings(module, "export_path", &ExportPath, table, R"(
Writes the path of a recording that was tracked in Python for another tool, as
export_run does it with a run. The recording is read again, with its colours.

recording: a Recording, whose frames have the time stamps of the path.
trajectory: world_from_cam of its frames, as in evaluate_ate, such as
    slam.trajectory. All poses must be of one world: leave out frames of other
    segments.
to: the format, one of export_formats() but "g2o".
output: file or folder to write.

Returns an Export. Raises InputError for a path that is not of the recording, for
invalid arguments and if something cannot be read or written.)",
                     py::arg("recording").none(false), py::arg("trajectory"),
                     py::arg("to"), py::arg("output"));
  DefineWithSettings(module, "export_map", &ExportMap, table, R"(
Writes the largest connected part of a map for another tool, as rgbd_export does.
Its images are the grey ones of its keyframes; "g2o" has all parts.

map: the folder of the map, as Slam.save_map writes it.
to: the format, one of export_formats().
output: file or folder to write, outside the folder of the map.

Returns an Export. Raises InputError for a folder without a map, for a damaged
map, for invalid arguments and if something cannot be written.)",
                     py::arg("map"), py::arg("to"), py::arg("output"));
}

}  // namespace rgbd_pose
