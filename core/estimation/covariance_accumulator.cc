#include "core/estimation/covariance_accumulator.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/estimation/degeneracy.h"
#include "core/estimation/residual_jacobian.h"
#include "core/util/quantile.h"
#include "core/util/small_matrix.h"

namespace rgbd_pose {
namespace {

// With fewer blocks their scatter is too uncertain to be used as a covariance.
constexpr double kMinBlocksForScatter = 30.0;

// Minimum share of the weight: with redescending losses the slope can vanish.
constexpr double kMinSlope = 0.2;

// Quantised depths make slopes up to this much noisier than their model.
constexpr double kSpuriousCostMargin = 6.0;

// Measurements are rounded: depths of 1 to 4 m to 0.2 or 1 mm and corners to a
// fiftieth of a pixel, which is about a twentieth of a sigma.
constexpr double kRounding = 0.05;

// Candidates for a test against chance: more prove no more.
constexpr size_t kMostCandidates = 1000;

// The noise model counts as this many rows that scatter as it says: it is taken
// to know variances to a factor of 1 +- sqrt(2 / 6).
constexpr double kModelRows = 6.0;

// Subtracts the spurious part from the information, which is zero, not
// negative, in directions in which all of it is spurious.
MotionMatrix LessSpurious(const MotionMatrix& hessian,
                          const MotionMatrix& spurious) {
  if (spurious.isZero() || !spurious.allFinite()) return hessian;
  MotionVector unit = hessian.diagonal();
  for (double& value : unit) value = value > 0.0 ? 1.0 / std::sqrt(value) : 1.0;
  constexpr double kSingular = 1e-12;
  MotionMatrix scaled = unit.asDiagonal() * hessian * unit.asDiagonal();
  scaled.diagonal().array() += kSingular;
  const Eigen::LLT<MotionMatrix> llt(scaled);
  if (llt.info() != Eigen::Success) return MotionMatrix::Zero();
  const MotionMatrix L = llt.matrixL();
  const MotionMatrix half =
      llt.matrixL().solve(unit.asDiagonal() * spurious * unit.asDiagonal());
  const auto eigen =
      EigenOf(MotionMatrix(llt.matrixL().solve(half.transpose())));
  const MotionVector left =
      (1.0 - eigen.eigenvalues().array()).cwiseMax(0.0).sqrt();
  const MotionMatrix root = unit.cwiseInverse().asDiagonal() * L *
                            eigen.eigenvectors() * left.asDiagonal();
  return root * root.transpose();
}

// Whether the blocks are of matches, not of pixels or of a prior.
bool IsOfMatches(const RobustTerm& term) {
  const std::vector<int>& matches = term.cost->matches();
  return term.has_scale() && !matches.empty() && matches.front() >= 0;
}

// Least squares of inliers, with the weight of their term in the sum; nothing
// of the others.
class InliersOnly final : public ceres::LossFunction {
 public:
  InliersOnly(double limit, double factor) : limit_(limit), factor_(factor) {}
  void Evaluate(double s, double rho[3]) const override {
    rho[0] = factor_ * std::min(s, limit_);
    rho[1] = s <= limit_ ? factor_ : 0.0;
    rho[2] = 0.0;
  }

 private:
  double limit_;  // of the squared norm
  double factor_;
};

// The same for a cost that has another limit for each match.
void AddInliers(const RobustTerm& term, const Rigid3d& cur_from_prev,
                NormalEquations* sum) {
  const ResidualJacobian jacobian =
      DifferenceJacobian(*term.cost, cur_from_prev);
  std::vector<double> residuals;
  term.cost->Residuals(DerivativesAt(cur_from_prev), &residuals);
  const int rows = term.cost->num_residuals();
  for (size_t k = 0; k < term.norms.size(); ++k) {
    const double limit = term.cost->InlierLimit(static_cast<int>(k));
    if (term.norms[k] > term.scale * term.scale * limit) continue;
    const size_t first = k * rows;
    const auto J = jacobian.middleRows(static_cast<Eigen::Index>(first), rows);
    const auto r = Eigen::Map<Eigen::VectorXd>(&residuals[first], rows);
    sum->hessian += term.factor() * J.transpose() * J;
    sum->gradient += term.factor() * J.transpose() * r;
  }
}

// Whether far outliers pull as much as residuals of 3 sigmas, as under Huber's
// loss.
bool PullsAtAnyDistance(const ScaledLoss& loss, double scale) {
  const auto pull = [&](double sigmas) {
    double rho[3];
    loss.Evaluate(sigmas * sigmas * scale * scale, rho);
    return sigmas * rho[1];
  };
  return pull(100.0) > 0.5 * pull(3.0);
}

}  // namespace

MotionMatrix RobustCovariance(const std::vector<CovarianceTerm>& terms,
                              const MotionMatrix& inverse) {
  MotionMatrix A = MotionMatrix::Zero(), B = MotionMatrix::Zero();
  MotionMatrix exact = MotionMatrix::Zero();
  for (const CovarianceTerm& term : terms) {
    if (term.scale_group == MotionCost::kFixedScale) {
      exact += term.hessian;
      continue;
    }
    LossSums sums;
    MotionMatrix group = MotionMatrix::Zero();
    for (const CovarianceTerm& other : terms) {
      if (other.scale_group != term.scale_group) continue;
      sums += other.sums;
      group += other.hessian;
    }
    if (!(sums.weight_p > 0.0)) continue;
    const double least_psi2 = kRounding * kRounding * sums.model_psi2;
    const bool by_hessian = term.is_whitened ||
                            term.sums.blocks < kMinBlocksForScatter ||
                            sums.psi2 < least_psi2;
    const double psi2 = std::max(sums.psi2, least_psi2);
    // Six rows, less what priors and other groups determine, fit any motion.
    const double fitted = (inverse * group).trace();
    const double left = std::max(sums.weight_p - fitted, 0.0) + kModelRows;
    const MotionMatrix one_row = 1.0 / sums.weight_p * term.hessian;
    const double blocks = term.sums.blocks;
    const MotionMatrix scatter =
        by_hessian ? MotionMatrix(psi2 * one_row)
                   : MotionMatrix(blocks / (blocks - 7.0) * term.scatter);
    B += sums.weight_p / left * (scatter + kModelRows * one_row);
    A += std::max(sums.slope_p / sums.weight_p, kMinSlope) * term.hessian;
  }
  const MotionMatrix A_inverse =
      (A + exact).llt().solve(MotionMatrix::Identity());
  return A_inverse * (B + exact) * A_inverse;
}

void CovarianceAccumulator::JudgeMatches(const RobustProblem& problem,
                                         MotionEstimate* estimate) {
  counted_.assign(estimate->is_inlier.size(), false);
  shares_.resize(problem.terms().size());
  estimate->num_inliers = 0;
  for (size_t i = 0; i < shares_.size(); ++i) {
    const RobustTerm& term = problem.terms()[i];
    const double scale2 = term.scale * term.scale;
    const double information = term.cost->information_factor();
    const double factor = term.factor();
    LossSums& sums = shares_[i].sums;
    sums = LossSums();
    for (size_t k = 0; k < term.norms.size(); ++k) {
      const int p = term.cost->degrees()[k];
      const double s = term.norms[k];
      double rho[3];
      term.scaled.Evaluate(s, rho);
      const double weight = rho[1] / factor;
      sums.psi2 += information * weight * weight * s / scale2;
      sums.weight_p += information * weight * p;
      sums.slope_p += information * (weight * p + 2.0 * s * rho[2] / factor);
      sums.blocks += information * weight;
      const double limit = term.cost->is_whitened() ? ChiSquared99(p)
                                                    : term.cost->InlierLimit(k);
      // The squared sigma in the unit of the residuals is limit / ChiSquared99.
      sums.model_psi2 +=
          information * weight * p * limit / ChiSquared99(p) / scale2;
      const bool agrees = s <= limit * scale2;
      const int of_camera = term.cost->matches()[k];
      if (of_camera < 0) {
        if (agrees && term.has_scale()) ++estimate->num_inliers;
        continue;
      }
      const size_t match = term.first_match + of_camera;
      // A match that several costs use is an inlier if it agrees with all of
      // them. Losses steeper than least squares near 0 have weights above 1.
      const bool again = counted_[match];
      estimate->is_inlier[match] =
          agrees && (!again || estimate->is_inlier[match]);
      estimate->weights[match] =
          std::min(weight, again ? estimate->weights[match] : 1.0);
      counted_[match] = true;
      const double norm = std::sqrt(s);
      if (norm >= estimate->residual_norms[match]) {
        estimate->residual_norms[match] = norm;
        estimate->residual_degrees[match] = p;
      }
    }
  }
  estimate->num_inliers += static_cast<int>(
      std::count(estimate->is_inlier.begin(), estimate->is_inlier.end(), true));
}

double CovarianceAccumulator::FalseAlarmsOf(const RobustProblem& problem,
                                            const MotionMatrix& inverse,
                                            double max_standard_deviation) {
  double scale = 0.0, determined = 0.0;
  MotionMatrix priors = MotionMatrix::Zero();
  agreements_.clear();
  for (size_t i = 0; i < shares_.size(); ++i) {
    const RobustTerm& term = problem.terms()[i];
    if (!term.has_scale()) {
      priors += shares_[i].hessian;
      continue;
    }
    determined += (inverse * shares_[i].hessian).trace();
    scale = std::max(scale, term.scale);
    const size_t step = 1 + term.norms.size() / kMostCandidates;
    for (size_t k = 0; k < term.norms.size(); k += step) {
      if (term.cost->matches()[k] < 0) return 0.0;
      const int p = term.cost->degrees()[k];
      const double limit = term.cost->is_whitened() ? ChiSquared99(p)
                                                    : term.cost->InlierLimit(k);
      agreements_.push_back({std::sqrt(term.norms[k] / limit), p});
    }
  }
  // Agreement with priors confirms as well, if it is one in all directions.
  if (!priors.isZero() &&
      !FindDegeneracy(priors, 0.0, max_standard_deviation).is_degenerate()) {
    return 0.0;
  }
  const int parameters = static_cast<int>(std::lround(determined));
  return parameters > 0 ? FalseAlarms(scale, parameters, &agreements_) : 0.0;
}

NormalEquations CovarianceAccumulator::Linearise(
    const RobustProblem& problem, const MotionDerivatives& motion) {
  NormalEquations sum;
  shares_.resize(problem.terms().size());
  for (size_t i = 0; i < shares_.size(); ++i) {
    const RobustTerm& term = problem.terms()[i];
    NormalEquations share;
    term.cost->Linearise(motion, term.scaled_or_null(), &share);
    MotionMatrix spurious = MotionMatrix::Zero();
    term.cost->AddSpuriousInformation(motion, &spurious);
    // Residuals larger than their noise do not make slopes noisier.
    const double excess = std::max(1.0, term.scale);
    double times = kSpuriousCostMargin * term.cost->information_factor() /
                   (excess * excess);
    // An image without content does not even have noise to subtract.
    for (int k = 0; k < 6; ++k) {
      if (times * spurious(k, k) > share.hessian(k, k)) {
        times = share.hessian(k, k) / spurious(k, k);
      }
    }
    // The sum may be indefinite: then some direction is not determined.
    shares_[i].hessian = LessSpurious(share.hessian, times * spurious);
    share.hessian -= times * spurious;
    shares_[i].gradient = share.gradient;
    sum.hessian += share.hessian;
    sum.gradient += share.gradient;
    sum.cost += share.cost;
  }
  return sum;
}

double CovarianceAccumulator::KnownByPixels(const RobustProblem& problem,
                                            const MotionVector& change) const {
  double known = 0.0;
  for (size_t i = 0; i < shares_.size(); ++i) {
    const RobustTerm& term = problem.terms()[i];
    if (!term.has_scale() || IsOfMatches(term)) continue;
    known += change.dot(shares_[i].hessian * change);
  }
  return known;
}

MotionMatrix CovarianceAccumulator::Covariance(const RobustProblem& problem,
                                               const MotionDerivatives& motion,
                                               const MotionMatrix& inverse) {
  for (size_t i = 0; i < shares_.size(); ++i) {
    const RobustTerm& term = problem.terms()[i];
    shares_[i].is_whitened = term.cost->is_whitened();
    shares_[i].scale_group = term.cost->scale_group();
    shares_[i].scatter.setZero();
    if (term.cost->is_whitened()) continue;
    term.cost->AddScoreOuterProduct(motion, term.scaled_or_null(),
                                    &shares_[i].scatter);
    // Blocks that are not independent scatter together.
    shares_[i].scatter /= term.cost->information_factor();
  }
  return RobustCovariance(shares_, inverse);
}

// With the sums H and g of the inliers alone, these would move the motion by
// -H^-1 g.
double CovarianceAccumulator::PullOfOutliers(
    const RobustProblem& problem, const Rigid3d& cur_from_prev,
    const MotionMatrix& covariance) const {
  // Pixels at edges and of hidden surfaces disagree in every pair.
  const auto pulls = [](const RobustTerm& term) {
    return IsOfMatches(term) && PullsAtAnyDistance(term.scaled, term.scale);
  };
  const auto& terms = problem.terms();
  if (std::none_of(terms.begin(), terms.end(), pulls)) return 0.0;
  const MotionDerivatives motion = DerivativesAt(cur_from_prev);
  NormalEquations inliers;
  for (const RobustTerm& term : terms) {
    if (!term.has_scale()) {
      term.cost->Linearise(motion, term.scaled_or_null(), &inliers);
    } else if (term.cost->is_whitened()) {
      const int p = term.cost->degrees_of_freedom();
      const InliersOnly only(term.scale * term.scale * ChiSquared99(p),
                             term.factor());
      term.cost->Linearise(motion, &only, &inliers);
    } else {
      AddInliers(term, cur_from_prev, &inliers);
    }
  }
  const MotionVector away = inliers.hessian.ldlt().solve(inliers.gradient);
  return away.dot(covariance.ldlt().solve(away));
}

// The estimate is a mean of both, nearer to the more certain one. With the
// information of the priors L L^T and e = L^-1 gradient, their difference from
// the estimate in sigmas, the covariance of e is I - L^T covariance L: where
// nothing else determines the motion, the estimate is the prior, and e tells
// nothing.
double CovarianceAccumulator::PriorChiSquared(
    const MotionMatrix& covariance) const {
  constexpr double kTellsNothing = 1e-3;
  MotionMatrix information = MotionMatrix::Zero();
  MotionVector gradient = MotionVector::Zero();
  for (const CovarianceTerm& term : shares_) {
    if (term.scale_group != MotionCost::kFixedScale) continue;
    information += term.hessian;
    gradient += term.gradient;
  }
  if (information.isZero()) return 0.0;
  // A prior may tell of some directions only: L is a symmetric root.
  const auto prior = EigenOf(information);
  const double least =
      kTellsNothing * kTellsNothing * prior.eigenvalues().maxCoeff();
  MotionVector root = MotionVector::Zero(), inverse_root = root;
  for (int k = 0; k < 6; ++k) {
    if (!(prior.eigenvalues()[k] > least)) continue;
    root[k] = std::sqrt(prior.eigenvalues()[k]);
    inverse_root[k] = 1.0 / root[k];
  }
  const MotionMatrix axes = prior.eigenvectors();
  const MotionVector e =
      inverse_root.asDiagonal() * (axes.transpose() * gradient);
  const MotionMatrix of_e = MotionMatrix::Identity() -
                            MotionMatrix(root.asDiagonal() * axes.transpose() *
                                         covariance * axes * root.asDiagonal());
  const auto scatter = EigenOf(of_e);
  double chi_squared = 0.0;
  for (int k = 0; k < 6; ++k) {
    if (!(scatter.eigenvalues()[k] > kTellsNothing)) continue;
    const MotionVector axis = scatter.eigenvectors().col(k);
    const double along = axis.dot(e);
    chi_squared += along * along / scatter.eigenvalues()[k];
  }
  return chi_squared;
}

}  // namespace rgbd_pose
