// What a run has found, in the form that another tool takes.

#include <gflags/gflags.h>

#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>

#include "apps/export/export_format.h"
#include "apps/shell/available_cores.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"

DEFINE_string(run, "",
              "folder that rgbd_odometry or rgbd_slam has written its results "
              "to");
DEFINE_string(to, "", "format");
DEFINE_string(output, "",
              "file or folder to write; empty: one in the folder of the run");
DEFINE_bool(overwrite, false, "replace a folder that an export has written");
DEFINE_string(dataset, "",
              "where the recording of the run is, if not where it was");
DEFINE_string(camera, "",
              "where the camera file of the run is, if not where it was");
DEFINE_double(min_distance, rgbd_pose::MotionFilter().min_distance,
              "in formats with images a frame takes part if the camera has "
              "moved so far (m) since the last one that did, or turned by "
              "--min_angle");
DEFINE_double(min_angle, rgbd_pose::MotionFilter().min_angle_deg,
              "in formats with images a frame takes part if the camera has "
              "turned so far (degrees) since the last one that did; 0: every "
              "frame");
DEFINE_bool(undistort, false,
            "images of an ideal camera, without distortion, for tools that "
            "know no other");
DEFINE_double(voxel, rgbd_pose::ExportOptions().voxel,
              "side of the cubes (m) of meshes and clouds");
DEFINE_double(max_depth, 0.0,
              "depths beyond (m) are left out of meshes and clouds; 0: those "
              "that the run left out, and for meshes beyond 4 m");
DEFINE_int32(max_points, rgbd_pose::ExportOptions().max_points,
             "points, at most, of the cloud that comes along with images");
DEFINE_int32(
    threads, 0,
    "threads that read images ahead; 0: one for each core; the result does "
    "not depend on it");

namespace rgbd_pose {
namespace {

ProgramInfo Info() {
  return {"rgbd_export",
          "writes what a run has found in the form that another tool takes.",
          "rgbd_export --run=runs/fr1_room --to=mesh --output=room.glb",
          {{"Input", {"run", "dataset", "camera"}},
           {"Output", {"to", "output", "overwrite"}},
           {"What takes part",
            {"min_distance", "min_angle", "undistort", "voxel", "max_depth",
             "max_points"}},
           {"Run", {"threads"}}},
          {{"to", ExportFormatNames()}}};
}

ExportOptions Options(const ExportFormat& format) {
  // At least 8 points: see VoxelCloud::Thin.
  if (FLAGS_max_points < 8) throw InputError("--max_points must be 8 or more");
  if (!(FLAGS_min_distance >= 0.0) || !(FLAGS_min_angle >= 0.0)) {
    throw InputError("--min_distance and --min_angle must not be negative");
  }
  ExportOptions options;
  options.output =
      FLAGS_output.empty()
          ? (std::filesystem::path(FLAGS_run) / format.default_output).string()
          : FLAGS_output;
  options.overwrite = FLAGS_overwrite;
  options.step = {FLAGS_min_distance, FLAGS_min_angle};
  options.undistort = FLAGS_undistort;
  options.voxel = FLAGS_voxel;
  options.max_depth = FLAGS_max_depth;
  options.max_points = FLAGS_max_points;
  options.threads = NumThreads(FLAGS_threads);
  return options;
}

int Main() {
  RequireFlag("run", FLAGS_run);
  RequireFlag("to", FLAGS_to);
  const ExportFormat& format = FindExportFormat(FLAGS_to);
  cv::setNumThreads(1);
  const FinishedRun run(FLAGS_run, FLAGS_dataset, FLAGS_camera);
  const std::string said = format.write(run, Options(format));
  std::fputs(said.c_str(), stdout);
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
