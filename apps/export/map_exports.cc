// Exports surfaces: a point cloud or a mesh.

#include <glog/logging.h>

#include <nlohmann/json.hpp>

#include "apps/export/export_format.h"
#include "apps/report/report_data.h"
#include "apps/report/report_page.h"
#include "apps/results/cloud_preview.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/fusion/mesh_file.h"
#include "frontend/fusion/mesh_fusion.h"
#include "frontend/fusion/surface_mesh.h"

namespace rgbd_pose {
namespace {

TriangleMesh ThinMesh(const TriangleMesh& mesh, double voxel) {
  TriangleMesh thin = mesh;
  for (int most = kMaxPreviewTriangles;
       thin.triangles.size() > kMaxPreviewTriangles ||
       thin.vertices.size() > kMaxPreviewVertices;
       most = most * 3 / 4) {
    thin = SimplifyMesh(mesh, static_cast<float>(voxel), most);
  }
  return thin;
}

// Adds a cloud or mesh to the page of the run, if there is one that can be
// written; without a folder there is none. `all`: the number of points or
// triangles before thinning.
void ShowInPage(const std::string& folder, const char* file,
                nlohmann::json preview, size_t all, size_t frames,
                const ExportOptions& options) {
  if (folder.empty()) return;
  preview["file"] = options.output;
  preview["all"] = all;
  preview["frames"] = frames;
  const std::filesystem::path path(folder);
  try {
    WriteFileAtomically(
        path / file,
        preview.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    if (HasReportLibrary() && std::filesystem::exists(path / "report.html")) {
      WriteFileAtomically(path / "report.html",
                          ReportPage("run", RunReportData(folder)));
    }
  } catch (const InputError& error) {
    LOG(WARNING) << "the page of the run does not show " << options.output
                 << ": " << error.what();
  }
}

}  // namespace

std::string ExportCloud(const FinishedRun& run, const ExportOptions& options) {
  RequireCloudFile(options.output);
  const std::unique_ptr<FrameSource> source = OpenRecording(run);
  CloudFusion cloud(FusionOf<FusionOptions>(source->camera(), run, options));
  ReadViews(run, options, source.get(), [&](const Frame& frame, int view) {
    cloud.Add(frame, run.trajectory[view].world_from_cam);
  });
  WritePly(options.output, cloud.cloud().Points());
  ShowInPage(run.folder, kCloudPreviewFile,
             CloudPreview(cloud.cloud().Thin(kMaxPreviewPoints)),
             cloud.cloud().size(), cloud.frames(), options);
  return Format("cloud       %d points of %d frames in %s\n",
                cloud.cloud().size(), cloud.frames(), options.output.c_str());
}

std::string ExportMesh(const FinishedRun& run, const ExportOptions& options) {
  RequireMeshFile(options.output);
  const std::unique_ptr<FrameSource> source = OpenRecording(run);
  MeshFusionOptions settings;
  settings.threads = options.threads;
  if (options.max_depth > 0.0) settings.max_depth = options.max_depth;
  MeshFusion fusion(FusionOf(source->camera(), run, options, settings));
  const std::vector<int> views =
      ReadViews(run, options, source.get(), [&](const Frame& frame, int view) {
        fusion.Add(frame, run.trajectory[view].world_from_cam);
      });
  const TriangleMesh mesh = fusion.Mesh();
  WriteMesh(options.output, mesh, run.level_from_world);
  ShowInPage(run.folder, kMeshPreviewFile,
             MeshPreview(ThinMesh(mesh, options.voxel)), mesh.triangles.size(),
             views.size(), options);
  return Format("mesh        %zu triangles of %zu frames in %s\n",
                mesh.triangles.size(), views.size(), options.output.c_str());
}

}  // namespace rgbd_pose
