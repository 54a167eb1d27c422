#include "frontend/map/ply_writer.h"

#include <cstdint>
#include <cstring>

#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// By shifts, so that the bytes do not depend on those of the machine.
void AppendLittleEndian(float value, std::string* bytes) {
  uint32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  for (int shift = 0; shift < 32; shift += 8) {
    bytes->push_back(static_cast<char>(bits >> shift & 0xFF));
  }
}

}  // namespace

std::string FormatPly(const std::vector<ColoredPoint>& points) {
  constexpr size_t kVertexBytes = 3 * sizeof(float) + 3;
  std::string bytes =
      "ply\n"
      "format binary_little_endian 1.0\n"
      "element vertex " +
      std::to_string(points.size()) +
      "\n"
      "property float x\n"
      "property float y\n"
      "property float z\n"
      "property uchar red\n"
      "property uchar green\n"
      "property uchar blue\n"
      "end_header\n";
  bytes.reserve(bytes.size() + kVertexBytes * points.size());
  for (const ColoredPoint& point : points) {
    for (int i = 0; i < 3; ++i) AppendLittleEndian(point.position[i], &bytes);
    for (const uint8_t value : {point.red, point.green, point.blue}) {
      bytes.push_back(static_cast<char>(value));
    }
  }
  return bytes;
}

void WritePly(const std::string& path,
              const std::vector<ColoredPoint>& points) {
  WriteFileAtomically(path, FormatPly(points));
}

}  // namespace rgbd_pose
