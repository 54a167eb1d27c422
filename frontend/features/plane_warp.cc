#include "frontend/features/plane_warp.h"

#include <Eigen/LU>
#include <cmath>

namespace rgbd_pose {
namespace {

// A surface seen at less than this to its plane (sine of 15 degrees) has a
// normal too uncertain to be used.
constexpr double kMinIncidence = 0.26;

}  // namespace

// Along the plane n . X = const the depth changes so that the point X = z r of
// the ray r = [(u - cx) / fx, (v - cy) / fy, 1] moves by
//   dX/du = z / fx (e_x - n_x / (n . r) r), and v likewise.
Eigen::Matrix2f PlaneWarp(const Camera& camera, const Observation& ref,
                          const Rigid3d& cur_from_ref) {
  const Eigen::Vector3d ray = camera.Ray(ref.u, ref.v);
  Eigen::Vector3d normal = ref.normal;
  if (std::abs(normal.dot(ray)) < kMinIncidence * ray.norm()) {
    normal = Eigen::Vector3d::UnitZ();
  }
  const Eigen::RowVector2d tilt =
      normal.head<2>().transpose() / normal.dot(ray);
  Eigen::Matrix<double, 3, 2> moved;
  moved.leftCols<2>() = -ray * tilt;
  moved(0, 0) += 1.0;
  moved(1, 1) += 1.0;
  moved.col(0) *= ref.depth / camera.fx;
  moved.col(1) *= ref.depth / camera.fy;
  moved = cur_from_ref.rotation.toRotationMatrix() * moved;
  const Eigen::Vector3d point = cur_from_ref * (ref.depth * ray);
  Eigen::Matrix2d warp;
  for (int i = 0; i < 2; ++i) {
    const double f = (i == 0 ? camera.fx : camera.fy) / point.z();
    warp.row(i) = f * (moved.row(i) - point[i] / point.z() * moved.row(2));
  }
  if (camera.HasDistortion()) {
    // Of ideal pixels so far.
    const Eigen::Vector2d focal(camera.fx, camera.fy);
    warp = camera.ProjectDerivative(point.head<2>() / point.z()) *
           focal.cwiseInverse().asDiagonal() * warp * focal.asDiagonal() *
           camera.ProjectDerivative(ray.head<2>()).inverse();
  }
  return warp.cast<float>();
}

}  // namespace rgbd_pose
