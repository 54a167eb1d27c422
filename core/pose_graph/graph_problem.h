#pragma once

#include <ceres/problem.h>

#include <Eigen/SparseCore>
#include <deque>
#include <memory>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/factors/blocks.h"
#include "core/pose_graph/pose_graph.h"
#include "core/pose_graph/sparse_inverse.h"

namespace rgbd_pose {

// A graph as one Ceres problem: poses, RelativePoseFactors and
// CommonDirectionFactors.
class GraphProblem {
 public:
  // The losses are widened by the factor `width`.
  GraphProblem(const GraphTerms& graph, double width);

  // Whether no measurement could move a pose.
  bool is_empty() const { return problem_->NumResidualBlocks() == 0; }

  // Its cost is half the sum of squares under the losses.
  ceres::Problem* problem() { return problem_.get(); }

  Rigid3d WorldFromCam(int pose) const { return RigidOf(x_[pose]); }

  // Root of the sum of the squares of the numbers of all poses that are moved.
  double norm() const;

  // A pose that is not determined by `graph`, from which this was made; -1 if
  // there is none. See PoseGraphOptions::max_standard_deviation.
  int FindUndetermined(const GraphTerms& graph, double max_standard_deviation);

  // See PoseGraph::MarginalCovariances.
  std::vector<MotionMatrix> MarginalCovariances(const std::vector<int>& poses);

 private:
  bool IsConstant(int pose) const { return columns_[pose] < 0; }

  // J^T J of all residuals under their losses, by the poses that are not fixed.
  Eigen::SparseMatrix<double> Information();

  // The covariance between two poses in their tangents (PoseBlock), zero if one
  // of them is fixed.
  MotionMatrix CovarianceOf(const SparseInverse& inverse, int a, int b) const;

  PoseOf<double> PoseAt(int pose) const {
    return PoseBlock::Read(x_[pose].data());
  }

  std::vector<PoseVector> x_;
  std::vector<int> columns_;  // of a pose: the first of six; -1: it is fixed
  std::deque<ScaledLoss> losses_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace rgbd_pose
