#pragma once

#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/SparseCore>
#include <deque>
#include <memory>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/geometry/motion.h"
#include "core/pose_graph/pose_graph.h"
#include "core/pose_graph/sparse_inverse.h"

// The motion between two poses that are both estimated. A pose is itself a
// motion, from the world to the camera, in the parameters of
// core/geometry/motion.h about its own origin; C is the centre of the camera in
// the world. Between the cameras `ref` and `cur`:
//
//   R = R_cur R_ref^T,   C = R_ref (C_cur - C_ref)

namespace rgbd_pose {

using PosePairJacobian = Eigen::Matrix<double, 6, 12, Eigen::RowMajor>;
using RowMajorBlock = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// The motion from `ref` to `cur`, and d[omega C] / d[omega_ref C_ref omega_cur
// C_cur]: omega of a pose is about the axes of its camera, C in the world.
RotationAndCenter<double> MotionBetween(const RotationAndCenter<double>& ref,
                                        const RotationAndCenter<double>& cur,
                                        PosePairJacobian* jacobian);

// S with S^T S = information; NaN if that is not positive semi-definite.
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

  // Returns r. Turns `jacobian`, unless null, from d[omega C] / d[x_ref x_cur]
  // into d r / d[x_ref x_cur]; omega is as in MotionEstimate.
  MotionVector ResidualAt(const RotationAndCenter<double>& motion,
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

// A graph as one Ceres problem of six parameters per pose.
class GraphProblem {
 public:
  // The losses on edges are widened by the factor `width`.
  GraphProblem(const GraphTerms& graph, double width);

  // Whether no measurement could move a pose.
  bool is_empty() const { return problem_->NumResidualBlocks() == 0; }

  // Its cost is half the sum of squares under the losses.
  ceres::Problem* problem() { return problem_.get(); }

  // The parameters of a pose, and the pose they describe.
  const MotionVector& parameters(int pose) const { return x_[pose]; }
  Rigid3d WorldFromCam(int pose) const {
    return origins_[pose].CurFromPrev(x_[pose].data()).Inverse();
  }

  // A pose that is not determined by `graph`, from which this was made; -1 if
  // there is none. See PoseGraphOptions::max_standard_deviation.
  int FindUndetermined(const GraphTerms& graph, double max_standard_deviation);

  // See PoseGraph::MarginalCovariances.
  std::vector<MotionMatrix> MarginalCovariances(const std::vector<int>& poses);

 private:
  bool IsConstant(int pose) const { return columns_[pose] < 0; }

  // J^T J of all residuals under their losses, by the poses that are not fixed.
  Eigen::SparseMatrix<double> Information();

  // The covariance between two poses, zero if one of them is fixed.
  MotionMatrix CovarianceOf(const SparseInverse& inverse, int a, int b) const;

  std::vector<LinearizationPoint> origins_;
  std::vector<MotionVector> x_;
  std::vector<int> columns_;  // of a pose: the first of six; -1: it is fixed
  std::deque<ScaledLoss> losses_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace rgbd_pose
