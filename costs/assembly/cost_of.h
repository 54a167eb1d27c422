#pragma once

#include <memory>

#include "core/estimation/motion_cost.h"
#include "costs/assembly/packed_cost.h"

namespace rgbd_pose {

// Detect optional constants of a residual type.
template <typename Residual>
using IsPriorOf = decltype(Residual::kIsPrior);
template <typename Residual>
using AssociationOf = decltype(Residual::kAssociation);

// The MotionCost of a residual type over matches: binding, sums and the three
// assemblies. A residual type has no state and defines
//
//     kName              its name for programs
//     kRows              the number of residuals per match
//     kDegreesOfFreedom  how many of them are independent, which determines the
//                        widths of losses
//     kColumns           how many numbers it keeps per match
//     kAssociation       when to pack again. AssociationPolicy::kOnce (the
//                        default): never, as Pack uses measurements only;
//                        kWhenMoved: when the motion has changed considerably,
//                        as frozen weights depend on it (the default of
//                        WeightedForwardError); kEveryStep: after every solver
//                        step, as pixels are looked up elsewhere
//     kIsWhitened        whether the rows of correct matches have unit variance
//                        and are independent. If not, the covariance comes from
//                        their scatter, and InlierLimit(columns) gives the
//                        squared norm below which 99 % of correct matches lie
//
//     // Stores match i; false if it cannot be used (for example, a depth is
//     // missing). Never returns a zero residual instead.
//     static bool Pack(const CostInput& input, size_t i, double* columns);
//
//     // r for any scalars.
//     template <typename M, typename D, typename T>
//     static void Residual(const RotationAndCenter<M>& motion,
//                          const D* columns, T* r);
//
//     // r and dr/d[alpha beta gamma Cx Cy Cz], by hand. Without it, r is
//     // differentiated automatically, which takes several times as long.
//     template <typename D>
//     static void Jacobian(const MotionDerivatives& motion, const D* columns,
//                          D* r, D (*J)[6]);
//
// and, where they apply,
//
//     Degrees(columns)   if a match may lack measurements
//     kPointTerms, PointTerms
//                        one vector per point: sums take half the time
//                        (costs/parts/point_sums.h)
//     kIsPrior           it packs the prior, not matches
//                        (costs/matches/motion_prior.h)
template <typename Type>
class CostOf final : public PackedCost<Type> {
  using Residual = typename PackedCost<Type>::Residual;

 public:
  int scale_group() const override {
    return kIsPrior ? MotionCost::kFixedScale : 0;
  }

  AssociationPolicy association() const override {
    if constexpr (kHas<AssociationOf, Residual>) return Residual::kAssociation;
    return AssociationPolicy::kOnce;
  }

  // Stores the matches only if they have to be packed again.
  void Bind(const FramePair& pair) override {
    static const Correspondences none;
    const Correspondences& matches =
        pair.matches != nullptr ? *pair.matches : none;
    this->SetThreads(pair.threads);
    if (association() == AssociationPolicy::kOnce) {
      PackAll({matches, Rigid3d(), pair.prior});
    } else {
      kept_ = matches;
    }
  }

  void Associate(const Rigid3d& cur_from_prev) override {
    if (association() == AssociationPolicy::kOnce) return;
    PackAll({kept_, cur_from_prev});
  }

 private:
  static constexpr bool kIsPrior = kHas<IsPriorOf, Residual>;

  void PackAll(const CostInput& input) {
    const size_t num_priors = input.prior != nullptr ? 1 : 0;
    const size_t count = kIsPrior ? num_priors : input.matches.size();
    this->BeginBlocks(count);
    typename PackedCost<Type>::Block columns = {};
    for (size_t i = 0; i < count; ++i) {
      if (!Residual::Pack(input, i, columns.data())) continue;
      this->AddBlock(columns, kIsPrior ? -1 : static_cast<int>(i));
    }
    this->EndBlocks();
  }

  Correspondences kept_;  // see Bind
};

// The cost of your own residual type; costs/cost_factory.h makes the costs of
// this project by name.
template <typename Residual>
std::unique_ptr<MotionCost> MakeCost() {
  return std::make_unique<CostOf<Residual>>();
}

}  // namespace rgbd_pose
