#include "costs/factors/pair.h"

#include <array>
#include <cmath>
#include <utility>

#include "core/factors/motion_between.h"
#include "core/util/input_error.h"
#include "costs/assembly/compressed_block.h"

namespace rgbd_pose {
namespace {

constexpr int kRows = 7;  // of a compressed block with 6 parameters

RobustCost Checked(RobustCost cost) {
  if (cost.cost == nullptr) throw InputError("a pair factor needs a cost");
  return cost;
}

}  // namespace

PairFactor::PairFactor(RobustCost cost, const FramePair& pair,
                       const Rigid3d& cur_from_ref,
                       const PairMounting& mounting)
    : cost_(Checked(std::move(cost))),
      loss_(cost_.loss.get(), 1.0, cost_.cost->information_factor()),
      mounting_blocks_(mounting.blocks),
      ref_mounting_(PoseFrom(mounting.body_from_ref_cam)),
      cur_mounting_(PoseFrom(mounting.body_from_cur_cam)) {
  cost_.cost->Bind(pair);
  cost_.cost->Associate(cur_from_ref);
  set_num_residuals(kRows);
  const int num_blocks = mounting.blocks == PairMounting::kNone     ? 2
                         : mounting.blocks == PairMounting::kShared ? 3
                                                                    : 4;
  mutable_parameter_block_sizes()->assign(num_blocks, PoseBlock::kSize);
}

void PairFactor::Associate(const Rigid3d& cur_from_ref) {
  cost_.cost->Associate(cur_from_ref);
}

bool PairFactor::EvaluateCost(const MotionDerivatives& motion,
                              double* residuals) const {
  cost_.cost->SquaredNorms(motion, &norms_);
  // A loss may treat a residual that is not finite as an outlier.
  for (const double norm : norms_) {
    if (!std::isfinite(norm)) return false;
  }
  CompressedSums<6> sums;
  const int size = static_cast<int>(norms_.size());
  sums.cost = 0.5 * loss_.Weigh(norms_.data(), size, norms_.data());
  return FactorSums(sums, residuals, nullptr);
}

bool PairFactor::Evaluate(double const* const* x, double* residuals,
                          double** jacobians) const {
  const bool is_shared = mounting_blocks_ == PairMounting::kShared;
  const PoseOf<double> ref_body = PoseBlock::Read(x[0]),
                       cur_body = PoseBlock::Read(x[1]);
  PoseOf<double> ref_mounting = ref_mounting_, cur_mounting = cur_mounting_;
  if (mounting_blocks_ != PairMounting::kNone) {
    ref_mounting = PoseBlock::Read(x[2]);
    cur_mounting = PoseBlock::Read(x[is_shared ? 2 : 3]);
  }
  const PoseOf<double> ref = Mounted(ref_body, ref_mounting),
                       cur = Mounted(cur_body, cur_mounting);
  const RotationAndCenter<double> motion = MotionBetween(ref, cur);
  const MotionDerivatives derivatives = WithDerivatives(motion);
  if (jacobians == nullptr) return EvaluateCost(derivatives, residuals);

  NormalEquations sum;
  cost_.cost->Linearise(derivatives, &loss_, &sum);
  RowMajor<kRows, 6> by_motion;
  if (!FactorSums<6>({sum.hessian, sum.gradient, sum.cost}, residuals,
                     by_motion.data())) {
    return false;
  }
  const MotionJacobians poses(ref, motion);
  const MountedJacobians ref_chain(ref_body, ref_mounting),
      cur_chain(cur_body, cur_mounting);
  using ByPose = TangentJacobian<kRows, PoseBlock>;
  const ByPose by_ref = by_motion * poses.by_ref,
               by_cur = by_motion * poses.by_cur;
  const auto lift = [&](int block, const ByPose& by) {
    if (jacobians[block] == nullptr) return;
    PoseBlock::Lift<kRows>(by, x[block], jacobians[block]);
  };
  lift(0, by_ref * ref_chain.by_body);
  lift(1, by_cur * cur_chain.by_body);
  if (mounting_blocks_ == PairMounting::kNone) return true;
  const ByPose by_ref_mounting = by_ref * ref_chain.by_mounting,
               by_cur_mounting = by_cur * cur_chain.by_mounting;
  if (is_shared) {
    lift(2, by_ref_mounting + by_cur_mounting);
  } else {
    lift(2, by_ref_mounting);
    lift(3, by_cur_mounting);
  }
  return true;
}

}  // namespace rgbd_pose
