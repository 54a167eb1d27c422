// Exports transforms.json with images, depth and points in the format of
// nerfstudio (docs.nerf.studio/quickstart/data_conventions.html).

#include <nlohmann/json.hpp>

#include "apps/export/export_format.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/fusion/mesh_file.h"

namespace rgbd_pose {
namespace {

// world_from_cam with the camera axes of OpenGL: x right, y up, z backward.
nlohmann::json TransformMatrix(const Rigid3d& world_from_cam) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = world_from_cam.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = world_from_cam.translation;
  matrix.middleCols<2>(1) *= -1.0;
  nlohmann::json rows;
  for (const auto& row : matrix.rowwise()) {
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

nlohmann::json Transforms(const FinishedRun& run, const ExportedViews& images) {
  const Camera& camera = images.camera;
  const bool is_fisheye = camera.lens_model == LensModel::kEquidistant;
  if (camera.MakeLens().factor == Lens<double>::Factor::kRational) {
    throw InputError(
        "nerfstudio has no lens with k4 k5 k6; export with --undistort");
  }
  nlohmann::json json = {
      {"camera_model", is_fisheye ? "OPENCV_FISHEYE" : "OPENCV"},
      {"w", camera.width},
      {"h", camera.height},
      {"fl_x", camera.fx},
      {"fl_y", camera.fy},
      {"cx", camera.cx + kPixelCentre},
      {"cy", camera.cy + kPixelCentre},
      {"k1", camera.k1},
      {"k2", camera.k2},
      {"k3", camera.k3},
      {"k4", camera.k4},
      {"p1", camera.p1},
      {"p2", camera.p2},
      {"depth_unit_scale_factor", 0.001},
      // This is the identity, because the world is that of the trajectory.
      {"applied_transform", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
      {"ply_file_path", "points.ply"},
      {"frames", nlohmann::json::array()}};
  for (const int view : images.views) {
    const std::string name = ImageName(run, view);
    json["frames"].push_back(
        {{"file_path", "images/" + name},
         {"depth_file_path", "depth/" + name},
         {"transform_matrix",
          TransformMatrix(run.trajectory[view].world_from_cam)}});
  }
  return json;
}

}  // namespace

std::string ExportNerfstudio(const FinishedRun& run,
                             const ExportOptions& options) {
  OutputFolder folder(options.output, options.overwrite);
  const ExportedViews images = WriteViewImages(
      run, options, folder.MakeFolder("images"), folder.MakeFolder("depth"));
  WritePly(folder.staging_dir() / "points.ply", images.cloud);
  WriteFileAtomically(folder.staging_dir() / "transforms.json",
                      Transforms(run, images).dump(1) + "\n");
  folder.Publish();
  return Format("%zu images, %zu points in %s\n", images.views.size(),
                images.cloud.size(), options.output.c_str());
}

}  // namespace rgbd_pose
