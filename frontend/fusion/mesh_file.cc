#include "frontend/fusion/mesh_file.h"

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

using Formatter = std::string (*)(const TriangleMesh& mesh,
                                  const Rigid3d& level_from_world);

std::string FormatPly(const TriangleMesh& mesh, const Rigid3d&) {
  return FormatMeshPly(mesh);
}

// The function that writes each format, by file extension.
constexpr Named<Formatter> kFormats[] = {{".ply", FormatPly},
                                         {".glb", FormatGlb}};

Formatter FormatOf(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (const auto* format = FindNamed(kFormats, ending)) return format->value;
  throw InputError(path + ": the name of a mesh must end in one of " +
                   Join(NamesOf(kFormats)));
}

constexpr size_t kHeaderBytes = 12;
constexpr size_t kChunkHeaderBytes = 8;
constexpr size_t kPositionBytes = 3 * sizeof(float);
constexpr size_t kColorBytes = 4 * sizeof(uint16_t);

// Converts the sRGB colours of images (IEC 61966-2-1) to the linear colours of
// glTF vertices. 16 bits, because 8 bits would leave few dark colours.
std::array<uint16_t, 256> LinearColors() {
  std::array<uint16_t, 256> linear;
  for (size_t i = 0; i < linear.size(); ++i) {
    const double c = static_cast<double>(i) / 255.0;
    const double value =
        c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    linear[i] = static_cast<uint16_t>(std::lround(65535.0 * value));
  }
  return linear;
}

std::string Binary(const TriangleMesh& mesh) {
  static const std::array<uint16_t, 256> linear = LinearColors();
  std::string bytes;
  bytes.reserve((kPositionBytes + kColorBytes) * mesh.vertices.size() +
                kPositionBytes * mesh.triangles.size());
  for (const ColoredPoint& point : mesh.vertices) {
    const Eigen::Vector3f& p = point.position;
    for (const float x : {p.x(), -p.y(), -p.z()}) AppendLittleEndian(x, &bytes);
  }
  for (const ColoredPoint& point : mesh.vertices) {
    for (const uint8_t c : point.color) AppendLittleEndian(linear[c], &bytes);
    AppendLittleEndian(std::numeric_limits<uint16_t>::max(), &bytes);
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (const int vertex : triangle) AppendLittleEndian(vertex, &bytes);
  }
  return bytes;
}

std::string Json(const TriangleMesh& mesh, size_t binary_bytes) {
  const std::string asset =
      R"({"asset":{"version":"2.0","generator":"rgbd_pose"})";
  // An empty mesh gives a file without a scene: glTF forbids empty accessors.
  if (mesh.triangles.empty()) return asset + "}";
  Eigen::Vector3f low = mesh.vertices[0].position, high = low;
  for (const ColoredPoint& point : mesh.vertices) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  const size_t positions = kPositionBytes * mesh.vertices.size();
  const size_t colors = kColorBytes * mesh.vertices.size();
  return asset +
         Format(
             R"(,"extensionsUsed":["KHR_materials_unlit"],"scene":0,)"
             R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
             R"("materials":[{"pbrMetallicRoughness":{"metallicFactor":0},)"
             R"("doubleSided":true,"extensions":{"KHR_materials_unlit":{}}}],)"
             R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,)"
             R"("COLOR_0":1},"indices":2,"material":0}]}],)"
             R"("buffers":[{"byteLength":%zu}],"bufferViews":[)"
             R"({"buffer":0,"byteLength":%zu,"target":34962},)"
             R"({"buffer":0,"byteOffset":%zu,"byteLength":%zu,"target":34962},)"
             R"({"buffer":0,"byteOffset":%zu,"byteLength":%zu,"target":34963}],)"
             R"("accessors":[{"bufferView":0,"componentType":5126,"count":%zu,)"
             R"("type":"VEC3","min":[%.9g,%.9g,%.9g],"max":[%.9g,%.9g,%.9g]},)"
             R"({"bufferView":1,"componentType":5123,"normalized":true,)"
             R"("count":%zu,"type":"VEC4"},{"bufferView":2,)"
             R"("componentType":5125,"count":%zu,"type":"SCALAR"}]})",
             binary_bytes, positions, positions, colors, positions + colors,
             binary_bytes - positions - colors, mesh.vertices.size(), low.x(),
             -high.y(), -high.z(), high.x(), -low.y(), -low.z(),
             mesh.vertices.size(), 3 * mesh.triangles.size());
}

void AppendChunk(const std::string& type, const std::string& content,
                 std::string* bytes) {
  AppendLittleEndian(static_cast<uint32_t>(content.size()), bytes);
  *bytes += type;
  *bytes += content;
}

}  // namespace

std::string FormatGlb(const TriangleMesh& mesh,
                      const Rigid3d& level_from_world) {
  if (!level_from_world.IsIdentity()) {
    const Eigen::Matrix3f turn =
        level_from_world.rotation.toRotationMatrix().cast<float>();
    TriangleMesh level = mesh;
    for (ColoredPoint& point : level.vertices) {
      point.position = turn * point.position;
    }
    return FormatGlb(level);
  }
  const std::string binary =
      mesh.triangles.empty() ? std::string() : Binary(mesh);
  std::string json = Json(mesh, binary.size());
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const size_t total = kHeaderBytes + kChunkHeaderBytes + json.size() +
                       (binary.empty() ? 0 : kChunkHeaderBytes + binary.size());
  std::string bytes = "glTF";
  bytes.reserve(total);
  AppendLittleEndian(uint32_t{2}, &bytes);  // version
  AppendLittleEndian(static_cast<uint32_t>(total), &bytes);
  AppendChunk("JSON", json, &bytes);
  if (!binary.empty()) AppendChunk({"BIN\0", 4}, binary, &bytes);
  return bytes;
}

void WriteMesh(const std::string& path, const TriangleMesh& mesh,
               const Rigid3d& level_from_world) {
  WriteFileAtomically(path, FormatOf(path)(mesh, level_from_world));
}

void RequireCloudFile(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".ply") {
    throw InputError(path + ": a point cloud needs the extension .ply");
  }
  RequireWritable(path);
}

void RequireMeshFile(const std::string& path) {
  FormatOf(path);
  RequireWritable(path);
}

std::string FormatMeshPly(const TriangleMesh& mesh) {
  std::string bytes = Format(
      "ply\n"
      "format binary_little_endian 1.0\n"
      "element vertex %zu\n"
      "property float x\n"
      "property float y\n"
      "property float z\n"
      "property uchar red\n"
      "property uchar green\n"
      "property uchar blue\n",
      mesh.vertices.size());
  // A point cloud does not have this element.
  if (!mesh.triangles.empty()) {
    bytes += Format(
        "element face %zu\n"
        "property list uchar int vertex_indices\n",
        mesh.triangles.size());
  }
  bytes += "end_header\n";
  bytes.reserve(bytes.size() + (kPositionBytes + 3) * mesh.vertices.size() +
                (kPositionBytes + 1) * mesh.triangles.size());
  for (const ColoredPoint& point : mesh.vertices) {
    for (const float x : point.position) AppendLittleEndian(x, &bytes);
    bytes.append(point.color.begin(), point.color.end());
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (const int vertex : triangle) AppendLittleEndian(vertex, &bytes);
  }
  return bytes;
}

void WritePly(const std::string& path,
              const std::vector<ColoredPoint>& points) {
  WriteFileAtomically(path, FormatMeshPly({points, {}}));
}

}  // namespace rgbd_pose
