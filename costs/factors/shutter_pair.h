#pragma once

#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <utility>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/motion_between.h"
#include "core/geometry/motion.h"
#include "costs/assembly/compressed_block.h"
#include "costs/assembly/compressed_residuals.h"
#include "costs/factors/shutter_match.h"

namespace rgbd_pose {
namespace factors {

// What the residuals of two frames with a rolling shutter depend on: not on
// where both frames are in the world.
struct ShutterPairState {
  PoseOf<double> ref_from_cur;  // between the stamps
  MotionVector twist_ref, twist_cur;
};

// One match for CompressedResiduals, over the tangents of ref_from_cur (as a
// pose of `cur`), twist_ref and twist_cur.
template <typename Type>
struct ShutterPairMatch {
  static constexpr int kRows = Type::kRows, kParameters = 18;

  ShutterMatchFactor<Type> factor;

  bool operator()(const ShutterPairState& x, double* r, double* J) const {
    const PoseOf<double> ref = {Eigen::Quaterniond::Identity(),
                                Eigen::Vector3d::Zero()};
    if (J == nullptr) {
      return factor.Residual(ref, x.twist_ref, x.ref_from_cur, x.twist_cur, r);
    }
    TangentJacobian<kRows, PoseBlock> by_ref, by_cur;
    TangentJacobian<kRows, TwistBlock> by_twist_ref, by_twist_cur;
    if (!factor.Jacobian(ref, x.twist_ref, x.ref_from_cur, x.twist_cur, r,
                         &by_ref, &by_twist_ref, &by_cur, &by_twist_cur)) {
      return false;
    }
    Eigen::Map<RowMajor<kRows, kParameters>>(J) << by_cur, by_twist_ref,
        by_twist_cur;
    return true;
  }
};

}  // namespace factors

// All matches of two frames with a rolling shutter under one loss, as one block
// of 19 rows over the blocks of ShutterMatchFactor: pose and twist of `ref`,
// pose and twist of `cur`. The cost, the gradient and the Hessian of
// Gauss-Newton are those of one block per match under this loss, so a solver
// takes the same steps (docs/compressed_block.md). 18 numbers are enough for
// the 24 of the blocks, as moving both frames alike changes no residual.
//
// Add it without a loss: it is inside. Nothing is kept between evaluations, so
// the loss may change between solves (ceres::LossFunctionWrapper).
template <typename Type>
class ShutterPairFactor final
    : public ceres::SizedCostFunction<19, 7, 6, 7, 6> {
 public:
  // Takes the matches, with the times of their rows, and their loss; null is
  // least squares.
  explicit ShutterPairFactor(
      const std::vector<ShutterMatchFactor<Type>>& matches,
      std::unique_ptr<ceres::LossFunction> loss = nullptr)
      : loss_(std::move(loss)) {
    matches_.reserve(matches.size());
    for (const auto& match : matches) matches_.push_back({match});
  }

  // Fills in 19 residuals, whose squares add up to twice the cost. Returns
  // false if a residual is not finite.
  bool Evaluate(double const* const* x, double* residuals,
                double** jacobians) const override {
    const PoseOf<double> ref = PoseBlock::Read(x[0]),
                         cur = PoseBlock::Read(x[2]);
    const RotationAndCenter<double> motion = MotionBetween(ref, cur);
    const factors::ShutterPairState state = {
        {ref.q.conjugate() * cur.q, motion.C},
        TwistBlock::Read(x[1]),
        TwistBlock::Read(x[3])};
    CompressedSums<kParameters> sums;
    RowMajor<kRows, kParameters> J;
    double* const by = jacobians != nullptr ? J.data() : nullptr;
    const CompressedResiduals<Match> add(&matches_, loss_.get());
    if (!add(state, by != nullptr, &sums) || !FactorSums(sums, residuals, by)) {
      return false;
    }
    if (jacobians == nullptr) return true;
    // ref_from_cur turns the other way round than the motion.
    TangentJacobian<kRows, PoseBlock> by_motion = J.template leftCols<6>();
    by_motion.template leftCols<3>() *= -1.0;
    const MotionJacobians poses(ref, motion);
    const auto lift = [&](auto block, int i, const auto& by_block) {
      if (jacobians[i] == nullptr) return;
      decltype(block)::template Lift<kRows>(by_block, x[i], jacobians[i]);
    };
    lift(PoseBlock(), 0, by_motion * poses.by_ref);
    lift(TwistBlock(), 1, J.template middleCols<6>(6));
    lift(PoseBlock(), 2, by_motion * poses.by_cur);
    lift(TwistBlock(), 3, J.template rightCols<6>());
    return true;
  }

 private:
  using Match = factors::ShutterPairMatch<Type>;
  static constexpr int kParameters = Match::kParameters;
  static constexpr int kRows = kParameters + 1;

  std::vector<Match> matches_;
  const std::unique_ptr<ceres::LossFunction> loss_;
};

}  // namespace rgbd_pose
