#include "core/estimation/hidden_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/estimation/chance_agreement.h"
#include "core/estimation/residual_jacobian.h"
#include "core/util/quantile.h"
#include "core/util/small_matrix.h"

namespace rgbd_pose {
namespace {

constexpr size_t kMostBlocks = 100;

// With a lower leverage no error is hidden that moves the motion far.
constexpr double kShortLever = 0.4;

// Chi^2 of six degrees of freedom that is as rare as five sigmas.
constexpr double kFiveSigmas = 40.9;

// 99 % of the squared norms of inliers of block k are below this.
double SquaredLimit(const RobustTerm& term, size_t k) {
  return term.scale * term.scale * term.cost->InlierLimit(static_cast<int>(k));
}

// Whether wrong matches of this cost may hide. Three rows at least hardly ever
// agree by chance.
bool MayHideErrors(const RobustTerm& term) {
  const std::vector<int>& matches = term.cost->matches();
  return term.has_scale() && !matches.empty() && matches.front() >= 0 &&
         matches.size() <= kMostBlocks && term.cost->degrees_of_freedom() < 3;
}

MotionMatrix HiddenErrorsOf(const RobustTerm& term,
                            const Rigid3d& cur_from_prev,
                            const MotionMatrix& inverse,
                            const Eigen::LLT<MotionMatrix>& covariance) {
  MotionMatrix sum = MotionMatrix::Zero();
  std::vector<double> beyond;  // norms of blocks that disagree, in limits
  for (size_t k = 0; k < term.norms.size(); ++k) {
    const double limit = SquaredLimit(term, k);
    if (term.norms[k] <= limit) continue;
    beyond.push_back(std::sqrt(term.norms[k] / limit));
  }
  const size_t agreeing = term.norms.size() - beyond.size();
  if (beyond.empty() || agreeing == 0) return sum;
  const double odds = static_cast<double>(beyond.size()) / agreeing;
  const double median = UpperMedian(&beyond);
  const ResidualJacobian all = DifferenceJacobian(*term.cost, cur_from_prev);
  const int rows = term.cost->num_residuals();
  for (size_t k = 0; k < term.norms.size(); ++k) {
    if (term.norms[k] > SquaredLimit(term, k)) continue;
    double rho[3];
    term.scaled.Evaluate(term.norms[k], rho);
    const auto J = all.middleRows(static_cast<Eigen::Index>(k) * rows, rows);
    const SmallMatrix share = rho[1] * J * inverse * J.transpose();
    if (share.trace() < kShortLever) continue;
    const auto leverage = EigenOf(share);
    const double extent = ExtentOfWrong(median, term.cost->degrees()[k]);
    const double unseen = 1.0 - leverage.eigenvalues()[rows - 1];
    const double stretch = 1.0 / std::max(unseen, 1.0 / extent);
    const MotionVector moved = std::sqrt(SquaredLimit(term, k)) * stretch *
                               rho[1] * inverse * J.transpose() *
                               leverage.eigenvectors().col(rows - 1);
    if (moved.dot(covariance.solve(moved)) <= kFiveSigmas) continue;
    const double chance =
        odds * stretch * std::pow(extent, -term.cost->degrees()[k]);
    sum += std::min(chance, 1.0) * moved * moved.transpose();
  }
  return sum;
}

}  // namespace

MotionMatrix HiddenErrors(const RobustProblem& problem,
                          const Rigid3d& cur_from_prev,
                          const MotionMatrix& inverse,
                          const MotionMatrix& covariance) {
  MotionMatrix sum = MotionMatrix::Zero();
  const Eigen::LLT<MotionMatrix> known(covariance);
  for (const RobustTerm& term : problem.terms()) {
    if (!MayHideErrors(term)) continue;
    sum += HiddenErrorsOf(term, cur_from_prev, inverse, known);
  }
  return sum;
}

}  // namespace rgbd_pose
