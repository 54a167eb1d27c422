#include "frontend/fusion/mesh_file.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/fusion/little_endian.h"

namespace rgbd_pose {
namespace {

using Formatter = std::string (*)(const TriangleMesh& mesh);

// By file extension.
constexpr Named<Formatter> kFormats[] = {{".ply", FormatMeshPly},
                                         {".glb", FormatGlb}};

Formatter FormatOf(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (const auto* format = FindNamed(kFormats, ending)) return format->value;
  throw InputError(path + ": the name of a mesh must end in one of " +
                   Join(NamesOf(kFormats)));
}

constexpr uint32_t kGlbMagic = 0x46546C67;  // "glTF"
constexpr uint32_t kGlbVersion = 2;
constexpr uint32_t kJson = 0x4E4F534A;    // "JSON"
constexpr uint32_t kBinary = 0x004E4942;  // "BIN"
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

void Pad(char with, std::string* bytes) {
  while (bytes->size() % 4 != 0) bytes->push_back(with);
}

std::string Binary(const TriangleMesh& mesh) {
  static const std::array<uint16_t, 256> linear = LinearColors();
  std::string bytes;
  bytes.reserve((kPositionBytes + kColorBytes) * mesh.vertices.size() +
                kPositionBytes * mesh.triangles.size());
  for (const ColoredPoint& point : mesh.vertices) {
    AppendLittleEndian(point.position.x(), &bytes);
    AppendLittleEndian(-point.position.y(), &bytes);
    AppendLittleEndian(-point.position.z(), &bytes);
  }
  for (const ColoredPoint& point : mesh.vertices) {
    for (const uint8_t value : {point.red, point.green, point.blue}) {
      AppendLittleEndian(linear[value], &bytes);
    }
    AppendLittleEndian(std::numeric_limits<uint16_t>::max(), &bytes);
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (const int vertex : triangle) {
      AppendLittleEndian(static_cast<uint32_t>(vertex), &bytes);
    }
  }
  return bytes;
}

std::string Json(const TriangleMesh& mesh, size_t binary_bytes) {
  constexpr const char* kAsset =
      "{\"asset\":{\"version\":\"2.0\",\"generator\":\"rgbd_pose\"}";
  // An empty mesh gives a file without a scene: glTF forbids empty accessors.
  if (mesh.triangles.empty()) return std::string(kAsset) + "}";
  Eigen::Vector3f low = mesh.vertices[0].position, high = low;
  for (const ColoredPoint& point : mesh.vertices) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  const size_t positions = kPositionBytes * mesh.vertices.size();
  const size_t colors = kColorBytes * mesh.vertices.size();
  return std::string(kAsset) +
         ",\"extensionsUsed\":[\"KHR_materials_unlit\"],"
         "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
         "\"nodes\":[{\"mesh\":0}],"
         "\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0},"
         "\"doubleSided\":true,\"extensions\":{\"KHR_materials_unlit\":{}}}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
         "\"COLOR_0\":1},\"indices\":2,\"material\":0}]}]," +
         Format(
             "\"buffers\":[{\"byteLength\":%zu}],"
             "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu,"
             "\"target\":34962},{\"buffer\":0,\"byteOffset\":%zu,"
             "\"byteLength\":%zu,\"target\":34962},{\"buffer\":0,"
             "\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":34963}],",
             binary_bytes, positions, positions, colors, positions + colors,
             binary_bytes - positions - colors) +
         Format(
             "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
             "\"count\":%zu,\"type\":\"VEC3\",\"min\":[%.9g,%.9g,%.9g],"
             "\"max\":[%.9g,%.9g,%.9g]},",
             mesh.vertices.size(), low.x(), -high.y(), -high.z(), high.x(),
             -low.y(), -low.z()) +
         Format(
             "{\"bufferView\":1,\"componentType\":5123,"
             "\"normalized\":true,\"count\":%zu,\"type\":\"VEC4\"},"
             "{\"bufferView\":2,\"componentType\":5125,\"count\":%zu,"
             "\"type\":\"SCALAR\"}]}",
             mesh.vertices.size(), 3 * mesh.triangles.size());
}

void AppendChunk(uint32_t type, const std::string& content,
                 std::string* bytes) {
  AppendLittleEndian(static_cast<uint32_t>(content.size()), bytes);
  AppendLittleEndian(type, bytes);
  *bytes += content;
}

}  // namespace

std::string FormatGlb(const TriangleMesh& mesh) {
  const std::string binary =
      mesh.triangles.empty() ? std::string() : Binary(mesh);
  std::string json = Json(mesh, binary.size());
  Pad(' ', &json);
  std::string bytes;
  bytes.reserve(kHeaderBytes + 2 * kChunkHeaderBytes + json.size() +
                binary.size());
  AppendLittleEndian(kGlbMagic, &bytes);
  AppendLittleEndian(kGlbVersion, &bytes);
  const size_t total = kHeaderBytes + kChunkHeaderBytes + json.size() +
                       (binary.empty() ? 0 : kChunkHeaderBytes + binary.size());
  AppendLittleEndian(static_cast<uint32_t>(total), &bytes);
  AppendChunk(kJson, json, &bytes);
  if (!binary.empty()) AppendChunk(kBinary, binary, &bytes);
  return bytes;
}

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
  // A point cloud does not have this element.
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
