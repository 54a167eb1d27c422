// What CheckFactor says of factors with mistakes.

#include "core/factors/check_factor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "core/factors/relative_pose.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// The measured position of a pose, with one of several mistakes.
enum class Mistake {
  kNone,
  kSign,
  kResidual,
  kRefuses,
  kDroppedDerivative,
  kForgotten,
};

template <Mistake mistake>
struct PositionFactor {
  static constexpr char kName[] = "position";
  using Blocks = BlockList<VectorBlock<2>, PoseBlock>;
  static constexpr int kRows = 3;

  Eigen::Vector3d measured = Eigen::Vector3d(1.0, 2.0, 3.0);

  template <typename T>
  bool Residual(const Eigen::Matrix<T, 2, 1>& shift, const PoseOf<T>& pose,
                T* r) const {
    for (int i = 0; i < 3; ++i) r[i] = pose.p[i] - measured[i];
    r[0] += shift[0];
    if constexpr (mistake == Mistake::kDroppedDerivative) {
      if constexpr (std::is_same_v<T, double>) {
        r[1] += shift[1];
      } else {
        r[1] += shift[1].a;
      }
    } else {
      r[1] += shift[1];
    }
    return true;
  }

  bool Jacobian(const Eigen::Vector2d& shift, const PoseOf<double>& pose,
                double* r, TangentJacobian<3, VectorBlock<2>>* by_shift,
                TangentJacobian<3, PoseBlock>* by_pose) const {
    Residual(shift, pose, r);
    by_shift->setIdentity();
    if (mistake == Mistake::kDroppedDerivative) (*by_shift)(1, 1) = 0.0;
    if (mistake != Mistake::kForgotten) by_pose->setZero();
    by_pose->rightCols<3>().setIdentity();
    if (mistake == Mistake::kSign) (*by_pose)(2, 5) = -1.0;
    if (mistake == Mistake::kResidual) r[0] *= 2.0;
    return mistake != Mistake::kRefuses;
  }
};

TEST(CheckFactorTest, SaysNothingOfARightFactor) {
  EXPECT_EQ(CheckFactor(PositionFactor<Mistake::kNone>()), "");
}

TEST(CheckFactorTest, NamesRowBlockAndDirection) {
  EXPECT_EQ(CheckFactor(PositionFactor<Mistake::kSign>()),
            "position: row 2, block 1 (pose), position along z: -1 by hand, 1 "
            "by autodiff, 1 by differences (at 100 of 100 states)\n");
}

TEST(CheckFactorTest, ComparesTheResidualsOfBothFunctions) {
  const std::string said = CheckFactor(PositionFactor<Mistake::kResidual>());
  EXPECT_THAT(said, StartsWith("position: row 0: Jacobian fills in"));
  EXPECT_THAT(said, Not(HasSubstr("row 1")));
}

TEST(CheckFactorTest, SaysThatJacobianRefuses) {
  EXPECT_THAT(CheckFactor(PositionFactor<Mistake::kRefuses>()),
              StartsWith("position: Jacobian returns false at 100 states"));
}

// Memory that nobody has written to is often zero, as most derivatives are.
TEST(CheckFactorTest, FindsWhatJacobianDoesNotFillIn) {
  const std::string said = CheckFactor(PositionFactor<Mistake::kForgotten>());
  EXPECT_THAT(said,
              StartsWith("position: row 0, block 1 (pose), rotation about x: "
                         "nan by hand, 0 by autodiff"));
  EXPECT_THAT(said, Not(HasSubstr("block 0")));
}

// Jets and the hand agree, and both are wrong.
TEST(CheckFactorTest, DifferencesFindWhatJetsLose) {
  EXPECT_EQ(CheckFactor(PositionFactor<Mistake::kDroppedDerivative>()),
            "position: row 1, block 0 (vector), number 1: 0 by hand, 0 by "
            "autodiff, 1 by differences (at 100 of 100 states)\n");
}

// A residual that is defined near one state only.
struct NarrowFactor {
  static constexpr char kName[] = "narrow";
  using Blocks = BlockList<PoseBlock>;
  static constexpr int kRows = 1;

  template <typename T>
  bool Residual(const PoseOf<T>& pose, T* r) const {
    r[0] = pose.p[0] * pose.p[1];
    return pose.p[2] > T(99.0);
  }
};

TEST(CheckFactorTest, AsksForAStateWhereThereIsNone) {
  EXPECT_EQ(CheckFactor(NarrowFactor()),
            "narrow: could be evaluated at only 0 of 10000 random states: set "
            "CheckFactorOptions::near\n");
  CheckFactorOptions options;
  options.near = {{0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 100.0}};
  EXPECT_EQ(CheckFactor(NarrowFactor(), options), "");
  options.near = {{1.0, 2.0}};
  EXPECT_THROW(CheckFactor(NarrowFactor(), options), InputError);
}

TEST(CheckFactorTest, WithoutStatesNothingIsRight) {
  CheckFactorOptions options;
  for (const int samples : {0, -3}) {
    options.samples = samples;
    EXPECT_THROW(CheckFactor(PositionFactor<Mistake::kSign>(), options),
                 InputError);
    EXPECT_THROW(ErrorsOfFactor(PositionFactor<Mistake::kSign>(), options),
                 InputError);
  }
}

// They would be evaluated beyond the memory of the other function's results.
TEST(CheckFactorTest, RefusesFunctionsThatDoNotFitTogether) {
  const auto refused = [](auto spoil) {
    CheckableFactor factor = MakeCheckable(PositionFactor<Mistake::kNone>());
    spoil(&factor);
    EXPECT_THROW(CheckFactor(factor), InputError);
  };
  refused([](CheckableFactor* factor) { factor->by_hand.reset(); });
  refused([](CheckableFactor* factor) { factor->by_autodiff.reset(); });
  refused([](CheckableFactor* factor) { factor->kinds.pop_back(); });
  refused([](CheckableFactor* factor) {
    std::swap(factor->kinds[0], factor->kinds[1]);
  });
  refused([](CheckableFactor* factor) {
    factor->by_hand.reset(MakeFactor(NarrowFactor()));
  });
  refused([](CheckableFactor* factor) {
    struct OneRow : ceres::SizedCostFunction<1, 2, 7> {
      bool Evaluate(double const* const*, double*, double**) const override {
        return false;
      }
    };
    factor->by_hand = std::make_unique<OneRow>();
  });
}

}  // namespace
}  // namespace rgbd_pose
