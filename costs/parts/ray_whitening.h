#pragma once

#include "core/estimation/correspondences.h"
#include "costs/parts/point_sums.h"

namespace rgbd_pose {

// The point of an observation, and the whitening of a 3D error e at that point
// along the axes of the measurement. With x = a z and y = b z on the ray
// (a, b, 1), an error of (u, v, z) moves the point by
//
//   dx = (z / fx) du + a dz,  dy = (z / fy) dv + b dz,
//
// so the image parts of e are e_x - a e_z and e_y - b e_z, and
//
//   r = [ w_u (e_x - a e_z), w_v (e_y - b e_z), w_z e_z ],
//   w_u = fx / (z sigma_px), w_v = fy / (z sigma_px), w_z = 1 / sigma_depth:
//
// r = L^T e with L L^T the inverse of the point's 3 x 3 covariance (Khoshelham
// & Elberink 2012). D is double or a vector of doubles.
template <typename D>
struct RayWhitening {
  static constexpr int kColumns = 6;

  // Takes six columns: a, b, z, w_u, w_v, w_z.
  explicit RayWhitening(const D* columns)
      : a(columns[0]),
        b(columns[1]),
        point{columns[0] * columns[2], columns[1] * columns[2], columns[2]},
        w_u(columns[3]),
        w_v(columns[4]),
        w_z(columns[5]) {}

  // r = L^T e.
  template <typename T>
  void Whiten(const T* e, T* r) const {
    r[0] = w_u * (e[0] - a * e[2]);
    r[1] = w_v * (e[1] - b * e[2]);
    r[2] = w_z * e[2];
  }

  // The same for one column of a Jacobian, into rows J[0..2].
  template <typename T>
  void WhitenColumn(const T* e, D (*J)[6], int column) const {
    J[0][column] = w_u * (e[0] - a * e[2]);
    J[1][column] = w_v * (e[1] - b * e[2]);
    J[2][column] = w_z * e[2];
  }

  // The same for the three columns of -I, starting at `column`. Written out,
  // because a compiler must not leave out products with 0.
  void WhitenNegativeIdentity(D (*J)[6], int column) const {
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) J[row][column + k] = D{};
    }
    J[0][column] -= w_u;
    J[0][column + 2] += w_u * a;
    J[1][column + 1] -= w_v;
    J[1][column + 2] += w_v * b;
    J[2][column + 2] -= w_z;
  }

  // N = L L^T and n = -N e of a residual L^T (X - q) of the moved point q.
  void Square(const D* e, PointTerm<D>* term) const {
    const D uu = w_u * w_u;
    const D vv = w_v * w_v;
    const D au = a * uu;
    const D bv = b * vv;
    D* N = term->JtJ;
    N[0] = uu;
    N[1] = uu - uu;
    N[2] = -au;
    N[3] = vv;
    N[4] = -bv;
    N[5] = w_z * w_z + a * au + b * bv;
    term->Jtr[0] = au * e[2] - uu * e[0];
    term->Jtr[1] = bv * e[2] - vv * e[1];
    term->Jtr[2] = au * e[0] + bv * e[1] - N[5] * e[2];
  }

  D a, b;           // the ray: x / z, y / z
  D point[3];       // m
  D w_u, w_v, w_z;  // 1 / m
};

// The columns of an observation with depth; its sigmas are scaled.
inline void PackRay(const Camera& camera, const Observation& o,
                    double sigma_factor, double* columns) {
  // One division instead of three: this runs for every match of every estimate.
  const double sigma = o.depth * o.sigma_px;
  const double inverse = 1.0 / (sigma_factor * sigma * o.sigma_depth);
  const double image = inverse * o.sigma_depth;
  const Eigen::Vector3d ray = camera.Ray(o.u, o.v);
  columns[0] = ray.x();
  columns[1] = ray.y();
  columns[2] = o.depth;
  columns[3] = camera.fx * image;
  columns[4] = camera.fy * image;
  columns[5] = inverse * sigma;
}

}  // namespace rgbd_pose
