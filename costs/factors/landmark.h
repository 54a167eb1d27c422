#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The pixel at which a view sees a landmark: a point on a ray of another frame,
// its anchor, whose inverse depth there is estimated (Civera, Davison &
// Montiel, T-RO 2008). With the ray (x, y, 1) and the inverse depth d,
//
//   Y = R_view^T (R_anchor ray + d (p_anchor - p_view))
//   r = (project(Y) - pixel) / sigma_px
//
// Y is the landmark in the axes of the view times d, so points far away (d = 0)
// are no exception. Without a landmark in front of the view there is no
// residual: it returns false.
//
// The camera is constant; LandmarkPixelFactor estimates it
// (costs/calibration/landmark_factors.h).
struct LandmarkFactor {
  static constexpr char kName[] = "landmark";
  using Blocks = BlockList<PoseBlock, PoseBlock, InverseDepthBlock>;
  static constexpr int kRows = 2;
  using ByPose = TangentJacobian<kRows, PoseBlock>;
  using ByInverseDepth = TangentJacobian<kRows, InverseDepthBlock>;

  Camera camera;          // of the view
  Eigen::Vector3d ray;    // (x, y, 1) of the landmark in the anchor's axes
  Eigen::Vector2d pixel;  // as the view sees it, with the lens' distortion, px
  double sigma_px = 1.0;  // standard deviation of u and of v, px

  template <typename T>
  bool Residual(const PoseOf<T>& anchor, const PoseOf<T>& view,
                const Eigen::Matrix<T, 1, 1>& inverse_depth, T* r) const {
    const Eigen::Matrix<T, 3, 1> baseline = anchor.p - view.p;
    const Eigen::Matrix<T, 3, 1> Y =
        view.q.conjugate() *
        Eigen::Matrix<T, 3, 1>(anchor.q * ray.template cast<T>() +
                               inverse_depth[0] * baseline);
    if (!(Y.z() > T(0.0))) return false;
    T x, y;
    camera.MakeLens<T>().Distort(T(Y.x() / Y.z()), T(Y.y() / Y.z()), &x, &y);
    r[0] = (camera.fx * x + (camera.cx - pixel.x())) / sigma_px;
    r[1] = (camera.fy * y + (camera.cy - pixel.y())) / sigma_px;
    return true;
  }

  bool Jacobian(const PoseOf<double>& anchor, const PoseOf<double>& view,
                const Eigen::Matrix<double, 1, 1>& inverse_depth, double* r,
                ByPose* by_anchor, ByPose* by_view,
                ByInverseDepth* by_inverse_depth) const {
    const Eigen::Matrix3d view_from_world = view.R().transpose();
    const Eigen::Matrix3d view_from_anchor = view_from_world * anchor.R();
    const Eigen::Vector3d baseline = view_from_world * (anchor.p - view.p);
    const Eigen::Vector3d Y =
        view_from_anchor * ray + inverse_depth[0] * baseline;
    if (!(Y.z() > 0.0)) return false;
    const double z = 1.0 / Y.z(), x = Y.x() * z, y = Y.y() * z;
    DistortedPoint<double> seen;
    camera.MakeLens().Distort(x, y, &seen);
    const Eigen::Vector2d scale(camera.fx / sigma_px, camera.fy / sigma_px);
    r[0] = scale.x() * seen.x + (camera.cx - pixel.x()) / sigma_px;
    r[1] = scale.y() * seen.y + (camera.cy - pixel.y()) / sigma_px;
    Eigen::Matrix2d by_place;
    by_place << seen.x_x, seen.x_y, seen.x_y, seen.y_y;
    Eigen::Matrix<double, 2, 3> project;
    project << z, 0.0, -x * z, 0.0, z, -y * z;
    const Eigen::Matrix<double, 2, 3> by_point =
        scale.asDiagonal() * by_place * project;
    by_anchor->leftCols<3>() =
        -by_point * (view_from_anchor * CrossMatrix(ray));
    by_anchor->rightCols<3>() = inverse_depth[0] * by_point * view_from_world;
    by_view->leftCols<3>() = by_point * CrossMatrix(Y);
    by_view->rightCols<3>() = -by_anchor->rightCols<3>();
    *by_inverse_depth = by_point * baseline;
    return true;
  }

  static LandmarkFactor Sample(FactorSampler* random) {
    LandmarkFactor sample;
    sample.camera.k1 = random->Uniform(-0.2, 0.2);
    sample.camera.k2 = random->Uniform(-0.1, 0.1);
    sample.camera.p1 = random->Uniform(-0.01, 0.01);
    sample.camera.p2 = random->Uniform(-0.01, 0.01);
    sample.camera.fy = 500.0;
    sample.ray << random->Vector<2>(0.4), 1.0;
    sample.pixel = random->Vector<2>(200.0);
    sample.sigma_px = random->Uniform(0.5, 2.0);
    return sample;
  }

  // Two frames that look the same way, and a point 2 m away.
  static std::vector<std::vector<double>> Near() {
    return {{0.1, 0.2, 0.3, 0.9, 0.4, -0.2, 0.1},
            {0.2, 0.2, 0.2, 0.9, 0.1, -0.1, 0.3},
            {0.5}};
  }
};

}  // namespace rgbd_pose
