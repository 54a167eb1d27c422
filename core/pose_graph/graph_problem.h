#pragma once

#include <ceres/crs_matrix.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/geometry/motion.h"
#include "core/pose_graph/pose_graph.h"
#include "core/pose_graph/pose_pair.h"

namespace rgbd_pose {

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

  // r and, unless null, d r / d[x_ref x_cur].
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

// A graph as one Ceres problem: six parameters a pose, about where it is now,
// of which those of fixed poses are constant.
class GraphProblem {
 public:
  // Losses on edges are `width` times as wide as they are.
  GraphProblem(const GraphTerms& graph, double width);

  // Whether nothing is known that could move a pose.
  bool is_empty() const { return problem_->NumResidualBlocks() == 0; }

  // Half the sum of squares under the losses, at the parameters' values.
  double Cost();

  // Moves the parameters to where it is least.
  void Solve(const ceres::Solver::Options& options,
             ceres::Solver::Summary* summary);

  // The value of a pose's parameters, and where that puts it.
  const MotionVector& parameters(int pose) const { return x_[pose]; }
  Rigid3d WorldFromCam(int pose) const;

  // The rows of all residuals under their losses in the parameters of these
  // poses, six columns each, none of them fixed.
  ceres::CRSMatrix Jacobian(const std::vector<int>& poses);

  // See PoseGraph::MarginalCovariances.
  std::vector<MotionMatrix> MarginalCovariances(const std::vector<int>& poses,
                                                int threads);

 private:
  void AddEdge(const GraphTerms::Edge& edge, double width);
  bool IsConstant(int pose) const;

  std::vector<LinearizationPoint> origins_;
  std::vector<MotionVector> x_;
  std::deque<ScaledLoss> losses_;
  std::unique_ptr<ceres::Problem> problem_;
};

// Why the graph cannot be solved, as one line; empty: it can.
// Poses are named by the numbers that users know them by.
// Numbers that are not finite, and edges that are not between two poses.
std::string FindBadInput(const GraphTerms& graph);

// A pose that nothing joins to a fixed one or to the world.
std::string FindUnanchoredPose(const GraphTerms& graph);

// A pose of which some direction has a larger standard deviation (rad or m),
// all others held where they are or known no better.
std::string FindUndetermined(const GraphTerms& graph,
                             double max_standard_deviation,
                             GraphProblem* problem);

}  // namespace rgbd_pose
