#include "frontend/fusion/mesh_file.h"

#include <filesystem>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/fusion/ply_writer.h"

namespace rgbd_pose {
namespace {

struct MeshFormat {
  const char* name;  // the ending
  void (*write)(const std::string& path, const TriangleMesh& mesh);
};
constexpr MeshFormat kFormats[] = {{".ply", WriteMeshPly}, {".glb", WriteGlb}};

const MeshFormat& FormatOf(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  for (const MeshFormat& format : kFormats) {
    if (ending == format.name) return format;
  }
  throw InputError(path + ": the name of a mesh must end in one of " +
                   Join(NamesOf(kFormats)));
}

}  // namespace

void WriteMesh(const std::string& path, const TriangleMesh& mesh) {
  FormatOf(path).write(path, mesh);
}

void RequireMeshFile(const std::string& path) {
  FormatOf(path);
  RequireWritable(path);
}

}  // namespace rgbd_pose
