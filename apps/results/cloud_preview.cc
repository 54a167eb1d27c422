#include "apps/results/cloud_preview.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/util/format.h"

namespace rgbd_pose {

nlohmann::json CloudPreview(const std::vector<ColoredPoint>& points) {
  std::vector<Eigen::Vector3d> positions;
  Eigen::AlignedBox3d box;
  std::string position_bytes, color_bytes;
  for (const ColoredPoint& point : points) {
    positions.emplace_back(point.position.cast<double>());
    box.extend(positions.back());
    color_bytes.append(point.color.begin(), point.color.end());
  }
  if (points.empty()) box.extend(Eigen::Vector3d::Zero());
  const Eigen::Vector3d low = box.min();
  // All axes share one step. For a cloud of one point any step works.
  const double span = box.sizes().maxCoeff();
  const double step = span > 0.0 ? span / 65535.0 : 1.0;
  for (const Eigen::Vector3d& position : positions) {
    for (const double steps : Eigen::Vector3d((position - low) / step)) {
      AppendLittleEndian(static_cast<uint16_t>(std::lround(steps)),
                         &position_bytes);
    }
  }
  return {{"points", points.size()},
          {"origin_m", {low.x(), low.y(), low.z()}},
          {"step_m", step},
          {"positions", Base64(position_bytes)},
          {"colors", Base64(color_bytes)}};
}

nlohmann::json MeshPreview(const TriangleMesh& mesh) {
  nlohmann::json preview = CloudPreview(mesh.vertices);
  std::string corners;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (const int vertex : triangle) {
      AppendLittleEndian(static_cast<uint16_t>(vertex), &corners);
    }
  }
  preview["triangles"] = mesh.triangles.size();
  preview["corners"] = Base64(corners);
  return preview;
}

}  // namespace rgbd_pose
