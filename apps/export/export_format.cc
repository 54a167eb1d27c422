#include "apps/export/export_format.h"

#include "core/util/named_values.h"

namespace rgbd_pose {
namespace {

constexpr ExportFormat kFormats[] = {
    {"mesh", "mesh.ply", ExportMesh},
    {"cloud", "cloud.ply", ExportCloud},
    {"colmap", "colmap", ExportColmap},
    {"nerfstudio", "nerfstudio", ExportNerfstudio},
    {"kitti", "kitti", ExportKitti},
    {"tum", "trajectory_tum.txt", ExportTum},
    {"g2o", "poses.g2o", ExportG2o},
};

}  // namespace

std::vector<std::string> ExportFormatNames() { return NamesOf(kFormats); }

const ExportFormat& FindExportFormat(const std::string& name) {
  return RowOf(kFormats, "format", name);
}

}  // namespace rgbd_pose
