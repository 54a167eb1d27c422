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

  static RelativePoseErrorTerm Of(const Rigid3d& cur_from_ref,
                                  const MotionMatrix& root);

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
  double Cost();

  // Minimises the cost over the parameters.
  void Solve(const ceres::Solver::Options& options,
             ceres::Solver::Summary* summary);

  // The parameters of a pose, and the pose they describe.
  const MotionVector& parameters(int pose) const { return x_[pose]; }
  Rigid3d WorldFromCam(int pose) const;

  // The Jacobian of all residuals under their losses for the parameters of
  // these poses, six columns each. None of the poses may be fixed.
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

// The functions below return one line on why a graph cannot be solved, which
// names poses by their numbers, or an empty text. Here: values that are not
// finite, or an edge that does not connect two poses of the graph.
std::string FindBadInput(const GraphTerms& graph);

// A pose with no connection to a fixed pose.
std::string FindUnanchoredPose(const GraphTerms& graph);

// A pose with a direction whose standard deviation exceeds the limit (rad or
// m), with the others held fixed or estimated with it.
std::string FindUndetermined(const GraphTerms& graph,
                             double max_standard_deviation,
                             GraphProblem* problem);

}  // namespace rgbd_pose
