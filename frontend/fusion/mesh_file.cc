#include "frontend/fusion/mesh_file.h"

#include <filesystem>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

using Formatter = std::string (*)(const TriangleMesh& mesh);

// By the endings of files.
constexpr Named<Formatter> kFormats[] = {{".ply", FormatMeshPly},
                                         {".glb", FormatGlb}};

Formatter FormatOf(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (const auto* format = FindNamed(kFormats, ending)) return format->value;
  throw InputError(path + ": the name of a mesh must end in one of " +
                   Join(NamesOf(kFormats)));
}

}  // namespace

void WriteMesh(const std::string& path, const TriangleMesh& mesh) {
  WriteFileAtomically(path, FormatOf(path)(mesh));
}

void RequireMeshFile(const std::string& path) {
  FormatOf(path);
  RequireWritable(path);
}

}  // namespace rgbd_pose
