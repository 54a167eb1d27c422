#include "apps/python/estimate_rows.h"

#include <utility>

namespace rgbd_pose {
namespace {

Eigen::Vector3d Row(const NumberArray& array, size_t i) {
  return {array(i, 0), array(i, 1), array(i, 2)};
}

// The values of matches at the rows they were given in; zeros elsewhere.
template <typename To, typename From>
std::vector<To> AtRows(const std::vector<From>& values,
                       const std::vector<size_t>& rows, size_t size) {
  std::vector<To> result(size);
  for (size_t i = 0; i < rows.size(); ++i) result[rows[i]] = values[i];
  return result;
}

}  // namespace

Observation ObservePoint(const Camera& camera, const Eigen::Vector3d& point) {
  Observation o;
  o.u = camera.fx * point.x() / point.z() + camera.cx;
  o.v = camera.fy * point.y() / point.z() + camera.cy;
  o.depth = point.z();
  return o;
}

Observation ObservePixel(const Camera& camera, const Eigen::Vector3d& pixel) {
  const Eigen::Vector2d ideal = camera.Undistort(pixel.head<2>());
  Observation o;
  o.u = ideal.x();
  o.v = ideal.y();
  o.depth = pixel.z();
  return o;
}

RowMatches MakeMatches(const Camera& camera, ToObservation to_observation,
                       const NumberArray& prev, const NumberArray& cur,
                       const NumberArray* normals_cur, double sigma_px,
                       const DepthNoiseModel& depth_noise) {
  RowMatches result;
  result.matches = Correspondences(camera);
  result.matches.Reserve(prev.size());
  result.rows.reserve(prev.size());
  const auto observe = [&](const NumberArray& array, size_t i) {
    Observation o = to_observation(camera, Row(array, i));
    o.sigma_px = sigma_px;
    if (o.depth > 0.0) o.sigma_depth = depth_noise.sigma(o.depth);
    return o;
  };
  for (size_t i = 0; i < prev.size(); ++i) {
    Observation seen = observe(cur, i);
    if (normals_cur != nullptr) seen.normal = Row(*normals_cur, i);
    if (result.matches.Add(observe(prev, i), seen)) result.rows.push_back(i);
  }
  return result;
}

EstimateResult MakeResult(MotionEstimate estimate, const RowMatches& matches,
                          size_t size) {
  EstimateResult result;
  const std::vector<size_t>& rows = matches.rows;
  result.num_rejected = matches.matches.rejected();
  result.is_inlier = AtRows<uint8_t>(estimate.is_inlier, rows, size);
  if (result.num_rejected > 0) {
    estimate.weights = AtRows<double>(estimate.weights, rows, size);
    estimate.residual_norms =
        AtRows<double>(estimate.residual_norms, rows, size);
    estimate.residual_degrees =
        AtRows<int>(estimate.residual_degrees, rows, size);
  }
  result.estimate = std::move(estimate);
  return result;
}

}  // namespace rgbd_pose
