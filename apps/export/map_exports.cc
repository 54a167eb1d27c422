// What was seen: a point cloud or a mesh.

#include <filesystem>

#include "apps/export/export_format.h"
#include "apps/export/view_images.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/map/glb_writer.h"
#include "frontend/map/mesh_fusion.h"
#include "frontend/map/ply_writer.h"

namespace rgbd_pose {

std::string ExportCloud(const FinishedRun& run, const ExportOptions& options) {
  RunRecording recording(run);
  CloudFusion cloud(CloudOptions(recording.camera().camera, run, options));
  RequireWritable(options.output);
  recording.ReadViews(run.PickViews(options.step), options.threads,
                      [&](const Frame& frame, const Rigid3d& world_from_cam) {
                        cloud.Add(frame, world_from_cam);
                      });
  WritePly(options.output, cloud.cloud().Points());
  return Format("%d points of %d frames in %s\n", cloud.cloud().size(),
                cloud.frames(), options.output.c_str());
}

std::string ExportMesh(const FinishedRun& run, const ExportOptions& options) {
  const std::string ending =
      std::filesystem::path(options.output).extension().string();
  if (ending != ".ply" && ending != ".glb") {
    throw InputError("--output: " + options.output +
                     ": meshes are .ply or .glb files");
  }
  RunRecording recording(run);
  MeshFusionOptions fusion_options;
  fusion_options.camera = recording.camera().camera;
  fusion_options.voxel_size = options.voxel;
  fusion_options.threads = options.threads;
  fusion_options.depth = run.depth();
  if (options.max_depth > 0.0) {
    fusion_options.depth.max_depth = options.max_depth;
  }
  const std::string problem = fusion_options.Check();
  if (!problem.empty()) throw InputError("--voxel or --max_depth: " + problem);
  RequireWritable(options.output);
  MeshFusion fusion(fusion_options);
  const std::vector<int> views = run.PickViews(options.step);
  recording.ReadViews(views, options.threads,
                      [&](const Frame& frame, const Rigid3d& world_from_cam) {
                        fusion.Add(frame, world_from_cam);
                      });
  const TriangleMesh mesh = fusion.Mesh();
  if (ending == ".glb") {
    WriteGlb(options.output, mesh);
  } else {
    WriteMeshPly(options.output, mesh);
  }
  return Format("%zu triangles, %zu vertices of %zu frames in %s\n",
                mesh.triangles.size(), mesh.vertices.size(), views.size(),
                options.output.c_str());
}

}  // namespace rgbd_pose
