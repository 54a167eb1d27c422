#include "frontend/fusion/mesh_file.h"

#include <cstdint>
#include <filesystem>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/fusion/little_endian.h"

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

std::string FormatMeshPly(const TriangleMesh& mesh) {
  constexpr size_t kVertexBytes = 3 * sizeof(float) + 3;
  constexpr size_t kFaceBytes = 3 * sizeof(uint32_t) + 1;
  std::string bytes =
      "ply\n"
      "format binary_little_endian 1.0\n"
      "element vertex " +
      std::to_string(mesh.vertices.size()) +
      "\n"
      "property float x\n"
      "property float y\n"
      "property float z\n"
      "property uchar red\n"
      "property uchar green\n"
      "property uchar blue\n";
  // A cloud has no such element at all.
  if (!mesh.triangles.empty()) {
    bytes += "element face " + std::to_string(mesh.triangles.size()) +
             "\n"
             "property list uchar int vertex_indices\n";
  }
  bytes += "end_header\n";
  bytes.reserve(bytes.size() + kVertexBytes * mesh.vertices.size() +
                kFaceBytes * mesh.triangles.size());
  for (const ColoredPoint& point : mesh.vertices) {
    for (int i = 0; i < 3; ++i) AppendLittleEndian(point.position[i], &bytes);
    for (const uint8_t value : {point.red, point.green, point.blue}) {
      bytes.push_back(static_cast<char>(value));
    }
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (const int vertex : triangle) {
      AppendLittleEndian(static_cast<uint32_t>(vertex), &bytes);
    }
  }
  return bytes;
}

std::string FormatPly(const std::vector<ColoredPoint>& points) {
  return FormatMeshPly(TriangleMesh{points, {}});
}

void WritePly(const std::string& path,
              const std::vector<ColoredPoint>& points) {
  WriteFileAtomically(path, FormatPly(points));
}

}  // namespace rgbd_pose
