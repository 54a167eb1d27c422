#include "apps/python/matches.h"

#include <cmath>

#include "core/util/input_error.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

void CheckSizes(const NumberArray& prev, const std::string& prev_name,
                const NumberArray& other, const std::string& other_name) {
  if (prev.size() == other.size()) return;
  throw InputError(prev_name + " has " + std::to_string(prev.size()) +
                   " rows and " + other_name + " " +
                   std::to_string(other.size()) +
                   "; row i of both must belong to match i");
}

Eigen::Vector3d Row(const NumberArray& array, size_t i) {
  return {array(i, 0), array(i, 1), array(i, 2)};
}

}  // namespace

Observation ObservePoint(const Camera& camera, const Eigen::Vector3d& point) {
  return {camera.fx * point.x() / point.z() + camera.cx,
          camera.fy * point.y() / point.z() + camera.cy, point.z()};
}

Observation ObservePixel(const Camera& camera, const Eigen::Vector3d& pixel) {
  const Eigen::Vector2d ideal = camera.Undistort(pixel.head<2>());
  return {ideal.x(), ideal.y(), pixel.z()};
}

MatchArrays::MatchArrays(const py::object& prev, const std::string& prev_name,
                         const py::object& cur, const std::string& cur_name,
                         const py::object& normals_cur, double sigma_px)
    : prev_(prev, prev_name, {NumberArray::kAny, 3}),
      cur_(cur, cur_name, {NumberArray::kAny, 3}),
      sigma_px_(sigma_px) {
  CheckSizes(prev_, prev_name, cur_, cur_name);
  if (!normals_cur.is_none()) {
    normals_cur_.emplace(normals_cur, "normals_cur",
                         std::vector<py::ssize_t>{NumberArray::kAny, 3});
    CheckSizes(prev_, prev_name, *normals_cur_, "normals_cur");
  }
  if (!std::isfinite(sigma_px) || sigma_px <= 0.0) {
    throw InputError("sigma_px must be a positive number of pixels");
  }
}

RowMatches MatchArrays::Make(const Camera& camera, ToObservation to_observation,
                             const DepthNoiseModel& depth_noise) const {
  RowMatches result;
  result.matches = Correspondences(camera);
  result.rows.reserve(size());
  const auto observe = [&](const NumberArray& array, size_t i) {
    Observation o = to_observation(camera, Row(array, i));
    o.sigma_px = sigma_px_;
    if (o.depth > 0.0) o.sigma_depth = depth_noise.sigma(o.depth);
    return o;
  };
  for (size_t i = 0; i < size(); ++i) {
    Observation seen = observe(cur_, i);
    if (normals_cur_.has_value()) seen.normal = Row(*normals_cur_, i);
    if (result.matches.Add(observe(prev_, i), seen)) result.rows.push_back(i);
  }
  return result;
}

}  // namespace rgbd_pose
