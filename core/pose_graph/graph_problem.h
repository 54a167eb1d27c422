#pragma once

#include <ceres/crs_matrix.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <cmath>
#include <deque>
#include <memory>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/geometry/motion.h"
#include "core/pose_graph/pose_graph.h"

// The motion between two poses that are both estimated. A pose is itself a
// motion, from the world to the camera, in the parameters of
// core/geometry/motion.h about its own origin:
//
//   x = [alpha beta gamma Cx Cy Cz],  X_cam = R (X_world - C)
//
// Hence C is the centre of the camera in the world. Between the cameras `ref`
// and `cur`:
//
//   R = R_cur R_ref^T,   C = R_ref (C_cur - C_ref)

namespace rgbd_pose {

using PosePairJacobian = Eigen::Matrix<double, 6, 12, Eigen::RowMajor>;

// The rotation about the axes of the camera (rad) caused by small changes of
// the angles (rad) at x: the columns of d omega / d[alpha beta gamma].
inline Eigen::Matrix3d EulerRateJacobian(const double* x) {
  const double sb = std::sin(x[1]), cb = std::cos(x[1]);
  const double sg = std::sin(x[2]), cg = std::cos(x[2]);
  Eigen::Matrix3d axes;
  axes << cb * cg, -sg, 0, cb * sg, cg, 0, -sb, 0, 1;
  return axes;
}

// The motion between two poses and its derivatives.
struct RelativeMotion {
  RotationAndCenter<double> motion;
  // d[omega C] / d[x_ref x_cur]; omega (rad) is a small rotation about the axes
  // of `cur`, as in the covariance of MotionEstimate.
  PosePairJacobian jacobian;
};

inline RelativeMotion RelativeMotionAt(const LinearizationPoint& ref_origin,
                                       const double* x_ref,
                                       const LinearizationPoint& cur_origin,
                                       const double* x_cur) {
  const RotationAndCenter<double> ref = ref_origin.PoseAt(x_ref);
  const RotationAndCenter<double> cur = cur_origin.PoseAt(x_cur);
  RelativeMotion pair;
  pair.motion = {cur.R * ref.R.transpose(), ref.R * (cur.C - ref.C)};
  const Eigen::Matrix3d axes = EulerRateJacobian(x_ref);
  pair.jacobian.setZero();
  pair.jacobian.block<3, 3>(0, 0) = -pair.motion.R * axes;
  pair.jacobian.block<3, 3>(0, 6) = EulerRateJacobian(x_cur);
  pair.jacobian.block<3, 3>(3, 0) = -CrossMatrix(pair.motion.C) * axes;
  pair.jacobian.block<3, 3>(3, 3) = -ref.R;
  pair.jacobian.block<3, 3>(3, 9) = ref.R;
  return pair;
}

// S with S^T S = information, a positive semi-definite matrix. All elements are
// NaN if the matrix is invalid.
MotionMatrix SqrtInformation(const MotionMatrix& information);

// A measured motion between two poses as six rows,
//
//   r = S [ 2 vec q ; C - C_m ],   q the quaternion of R R_m^T,  q_w >= 0,
//
// with S^T S = covariance^-1. To first order, 2 vec q is omega in Exp(omega) =
// R R_m^T; it increases up to half a turn, as omega does.
struct RelativePoseErrorTerm {
  RotationAndCenter<double> measured;
  MotionMatrix root;  // S

  RelativePoseErrorTerm(const Rigid3d& cur_from_ref, const MotionMatrix& S)
      : measured{cur_from_ref.rotation.toRotationMatrix(),
                 cur_from_ref.Inverse().translation},
        root(S) {}

  // Returns r and writes d r / d[x_ref x_cur] to `jacobian` unless null.
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

// A graph as one Ceres problem: six parameters per pose, relative to its
// current value. The parameters of fixed poses are constant.
class GraphProblem {
 public:
  // The losses on edges are widened by the factor `width`.
  GraphProblem(const GraphTerms& graph, double width);

  // Whether no measurement could move a pose.
  bool is_empty() const { return problem_->NumResidualBlocks() == 0; }

  // Half the sum of squares under the losses, at the current parameters.
  double Cost() {
    double cost = 0.0;
    problem_->Evaluate({}, &cost, nullptr, nullptr, nullptr);
    return cost;
  }

  // Minimises the cost over the parameters.
  void Solve(const ceres::Solver::Options& options,
             ceres::Solver::Summary* summary) {
    ceres::Solve(options, problem_.get(), summary);
  }

  // The parameters of a pose, and the pose they describe.
  const MotionVector& parameters(int pose) const { return x_[pose]; }
  Rigid3d WorldFromCam(int pose) const {
    return origins_[pose].CurFromPrev(x_[pose].data()).Inverse();
  }

  // A pose with a direction whose standard deviation exceeds the limit (rad or
  // m), with the others held fixed or estimated with it; -1 if there is none.
  int FindUndetermined(double max_standard_deviation);

  // See PoseGraph::MarginalCovariances.
  std::vector<MotionMatrix> MarginalCovariances(const std::vector<int>& poses,
                                                int threads);

 private:
  bool IsConstant(int pose) const;

  std::vector<LinearizationPoint> origins_;
  std::vector<MotionVector> x_;
  std::deque<ScaledLoss> losses_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace rgbd_pose
