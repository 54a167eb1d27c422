#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/estimation/motion_cost.h"
#include "core/geometry/motion.h"
#include "core/util/lane_math.h"

namespace rgbd_pose {

// The epipolar constraint as Sampson's distance (Nister 2004; Hartley &
// Zisserman 2004, 11.4.3), for matches that lack at least one depth. With rays
// x = ((u - cx) / fx, (v - cy) / fy, 1) and E = R [C]x,
//
//   x_cur^T E x_prev = 0,   r = N / D,   N = x_cur^T E x_prev,
//   D^2 = su_cur^2 (E x_prev)_0^2 + sv_cur^2 (E x_prev)_1^2
//       + su_prev^2 (E^T x_cur)_0^2 + sv_prev^2 (E^T x_cur)_1^2 + eps^2
//
// where su = sigma_px / fx, sv = sigma_px / fy: D^2 - eps^2 is the variance of
// N to first order. N and D are proportional to |C|: the scale must come from
// other costs, and r would be 0 / 0 at C = 0. eps, the value of D at a baseline
// of kRestBaseline, keeps r finite and differentiable there.
//
// Two problems follow. C = 0 is a trap: all residuals vanish there, whatever
// the rotation. And a wrong match that happens to lie on its epipolar line
// outweighs tens of right ones, because it looks like a point just in front of
// the camera. So a match is used only if, at the bound motion, its rays see a
// baseline of at least kMinBaseline and meet in front of the cameras (Nister's
// cheirality), no nearer than kNearest, both within the noise. Solvers bind
// again as they proceed: without a baseline in the guess, other costs lead.
struct Epipolar {
  static constexpr char kName[] = "epipolar";
  static constexpr int kRows = 1;
  static constexpr int kDegreesOfFreedom = 1;
  static constexpr AssociationPolicy kAssociation =
      AssociationPolicy::kWhenMoved;
  static constexpr bool kIsWhitened = true;
  // a_prev, b_prev, a_cur, b_cur, su_cur^2, sv_cur^2, su_prev^2, sv_prev^2,
  // eps^2
  static constexpr int kColumns = 9;

  static constexpr double kRestBaseline = 1e-3;  // m
  static constexpr double kMinBaseline = 0.01;   // m
  static constexpr double kNearest = 0.2;        // m
  static constexpr double kSigmas = 3.0;         // of noise in the parallax

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Camera& camera = input.matches.camera();
    const Observation& prev = input.matches[i].prev;
    const Observation& cur = input.matches[i].cur;
    if (prev.depth > 0.0 && cur.depth > 0.0) return false;
    if (!SeesBaseline(camera, input.cur_from_prev, prev, cur)) return false;
    const double s[] = {cur.sigma_px / camera.fx, cur.sigma_px / camera.fy,
                        prev.sigma_px / camera.fx, prev.sigma_px / camera.fy};
    std::copy_n(camera.Ray(prev.u, prev.v).data(), 2, columns);
    std::copy_n(camera.Ray(cur.u, cur.v).data(), 2, columns + 2);
    columns[8] = 0.0;
    for (int k = 0; k < 4; ++k) {
      columns[4 + k] = s[k] * s[k];
      columns[8] += 0.25 * s[k] * s[k] * kRestBaseline * kRestBaseline;
    }
    return true;
  }

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    r[0] = Terms<D, T>(motion, columns).r;
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    const Terms<D, D> at(motion, columns);
    r[0] = at.r;
    for (int parameter = 0; parameter < 6; ++parameter) {
      D d_cur[3], d_prev[3];  // of line_cur = E x_prev, line_prev = E^T x_cur
      if (parameter < 3) {
        const Eigen::Matrix3d& dR = motion.dR[parameter];
        D turned[3];
        Multiply(dR, at.normal, d_cur);
        MultiplyTransposed(dR, at.x_cur, turned);
        Cross(turned, motion.C.data(), d_prev);
      } else {
        double axis[3] = {};
        axis[parameter - 3] = 1.0;
        D d_normal[3];
        Cross(axis, at.x_prev, d_normal);
        Multiply(motion.R, d_normal, d_cur);
        Cross(at.turned, axis, d_prev);
      }
      // The quotient rule: d(N / D) = (dN - r dD) / D, dD = d(D^2) / (2 D).
      const D dN = at.x_cur[0] * d_cur[0] + at.x_cur[1] * d_cur[1] + d_cur[2];
      const D half_d_squared = columns[4] * at.line_cur[0] * d_cur[0] +
                               columns[5] * at.line_cur[1] * d_cur[1] +
                               columns[6] * at.line_prev[0] * d_prev[0] +
                               columns[7] * at.line_prev[1] * d_prev[1];
      J[0][parameter] = (dN - at.r * half_d_squared / at.sigma) / at.sigma;
    }
  }

 private:
  // The point lies at w^-1 x_prev = C + (..) y with y = R^T x_cur, so
  // x_prev x y = w C x y: the parallax is the inverse depth w times the
  // component of the baseline across the ray.
  static bool SeesBaseline(const Camera& camera, const Rigid3d& cur_from_prev,
                           const Observation& prev, const Observation& cur) {
    const Eigen::Vector3d x_prev = camera.Ray(prev.u, prev.v),
                          x_cur = camera.Ray(cur.u, cur.v);
    const Eigen::Vector3d C = cur_from_prev.Inverse().translation;
    const Eigen::Vector3d y = cur_from_prev.rotation.conjugate() * x_cur;
    const Eigen::Vector3d across = C.cross(y);
    const double baseline = across.norm();
    if (baseline < kMinBaseline) return false;
    const double parallax = x_prev.cross(y).dot(across) / baseline;
    const double noise =
        kSigmas * std::hypot(prev.sigma_px, cur.sigma_px) / camera.fx;
    return parallax >= -noise && parallax <= baseline / kNearest + noise;
  }

  // The residual and its intermediate results.
  template <typename D, typename T>
  struct Terms {
    template <typename M>
    Terms(const RotationAndCenter<M>& motion, const D* columns)
        : x_prev{columns[0], columns[1], D{} + 1.0},
          x_cur{columns[2], columns[3], D{} + 1.0} {
      Cross(motion.C.data(), x_prev, normal);
      Multiply(motion.R, normal, line_cur);
      MultiplyTransposed(motion.R, x_cur, turned);
      Cross(turned, motion.C.data(), line_prev);
      const T N = x_cur[0] * line_cur[0] + x_cur[1] * line_cur[1] + line_cur[2];
      const T squared = columns[4] * line_cur[0] * line_cur[0] +
                        columns[5] * line_cur[1] * line_cur[1] +
                        columns[6] * line_prev[0] * line_prev[0] +
                        columns[7] * line_prev[1] * line_prev[1] + columns[8];
      sigma = sqrt(squared);
      r = N / sigma;
    }

    D x_prev[3], x_cur[3];  // rays
    T normal[3];            // C x x_prev: normal of the epipolar plane
    T turned[3];            // R^T x_cur
    T line_cur[3];          // E x_prev
    T line_prev[3];         // E^T x_cur
    T sigma;                // D
    T r;
  };
};

}  // namespace rgbd_pose
