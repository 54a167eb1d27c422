#pragma once

// What a graph of poses hands to Ceres: residual blocks in the parameters of
// two poses (core/pose_graph/pose_pair.h).

#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/pose_graph/pose_pair.h"

namespace rgbd_pose {

// What a PoseGraph holds, as its parts see it.
// Poses, by their numbers, and what is known of them.
struct GraphTerms {
  struct Pose {
    Rigid3d world_from_cam;
    bool is_fixed = false;
  };
  // A motion that was measured.
  struct Edge {
    int ref = 0, cur = 0;
    Rigid3d cur_from_ref;
    MotionMatrix root;  // see SqrtInformation
    const ceres::LossFunction* loss = nullptr;
  };
  std::vector<Pose> poses;
  std::vector<Edge> edges;

  // cur_from_ref as the poses have it.
  Rigid3d Between(int ref, int cur) const {
    return poses[cur].world_from_cam.Inverse() * poses[ref].world_from_cam;
  }

  // Whether there is such a pose.
  bool Has(int pose) const {
    return pose >= 0 && pose < static_cast<int>(poses.size());
  }

  // Whether what is between the two changes nothing.
  bool IsIdle(int ref, int cur) const {
    return poses[ref].is_fixed && poses[cur].is_fixed;
  }

  // By how many sigmas, squared, an edge disagrees with the poses.
  double SquaredMahalanobisDistance(const Edge& edge) const;
};

// S with S^T S = information, a positive semi-definite matrix; nothing (all
// NaN) if it is invalid.
MotionMatrix SqrtInformation(const MotionMatrix& information);

// A measured motion between two poses as six rows,
//
//   r = S [ 2 vec q ; C - C_m ],   q the quaternion of R R_m^T,  q_w >= 0,
//
// S^T S = covariance^-1. 2 vec q is the rotation Exp(omega) = R R_m^T to first
// order, and grows up to a half turn, where omega does.
struct RelativePoseErrorTerm {
  RotationAndCenter<double> measured;
  MotionMatrix root;  // S

  static RelativePoseErrorTerm Of(const Rigid3d& cur_from_ref,
                                  const MotionMatrix& root);

  // For any scalar, below a half turn: to check the other one by.
  template <typename T>
  void Residual(const RotationAndCenter<T>& motion, T* r) const {
    using std::sqrt;
    const Eigen::Matrix<T, 3, 3> E = motion.R * measured.R.transpose();
    // 4 w = 2 sqrt(1 + trace), vee(E - E^T) = 4 w vec q.
    const T half = sqrt(T(1.0) + E.trace());
    Eigen::Matrix<T, 6, 1> e;
    e << (E(2, 1) - E(1, 2)) / half, (E(0, 2) - E(2, 0)) / half,
        (E(1, 0) - E(0, 1)) / half, motion.C[0] - measured.C[0],
        motion.C[1] - measured.C[1], motion.C[2] - measured.C[2];
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(r);
    out.setZero();
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 6; ++k) out[i] += root(i, k) * e[k];
    }
  }

  // The same with d r / d[x_ref x_cur].
  MotionVector ResidualAt(const RelativeMotion& pair,
                          PosePairJacobian* jacobian) const;
};

// An edge with its hand-written Jacobian. The origins must outlive it.
class EdgeBlock final : public ceres::SizedCostFunction<6, 6, 6> {
 public:
  EdgeBlock(const RelativePoseErrorTerm& term, const LinearizationPoint* ref,
            const LinearizationPoint* cur)
      : term_(term), ref_(ref), cur_(cur) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const RelativePoseErrorTerm term_;
  const LinearizationPoint* const ref_;
  const LinearizationPoint* const cur_;
};

}  // namespace rgbd_pose
