// What a graph hands to Ceres, far from where poses begin.

#include "core/estimation/graph_blocks.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace rgbd_pose {
namespace {

class Randoms {
 public:
  explicit Randoms(int seed) : engine_(seed) {}

  double Uniform() { return uniform_(engine_); }  // -1..1

  Eigen::Vector3d Vector() { return {Uniform(), Uniform(), Uniform()}; }

  Rigid3d Motion(double angle) {
    const Eigen::Vector3d axis = Vector().normalized();
    return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), Vector()};
  }

  MotionVector Parameters(double size) {
    MotionVector x;
    for (double& value : x) value = size * Uniform();
    return x;
  }

 private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

// Six rows that are the parameters themselves.
class Parameters final : public ceres::SizedCostFunction<6, 6> {
 public:
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    std::copy_n(parameters[0], 6, residuals);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(jacobians[0])
          .setIdentity();
    }
    return true;
  }
};

using Rows = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

struct Evaluated {
  MotionVector residuals;
  std::array<Rows, 2> jacobians;  // by the poses ref and cur
};

Evaluated At(const ceres::CostFunction& block, const MotionVector& x_ref,
             const MotionVector& x_cur) {
  Evaluated out;
  const std::array<const double*, 2> parameters = {x_ref.data(), x_cur.data()};
  std::array<double*, 2> jacobians = {out.jacobians[0].data(),
                                      out.jacobians[1].data()};
  EXPECT_TRUE(block.Evaluate(parameters.data(), out.residuals.data(),
                             jacobians.data()));
  return out;
}

// Turns of tens of degrees, all three at once.
TEST(LiveBlockTest, IsTheBlockAtTheMotionBetweenThePoses) {
  Randoms random(1);
  const Parameters parameters;
  for (int i = 0; i < 20; ++i) {
    const MotionOrigin motion(random.Motion(0.7)), ref(random.Motion(1.0));
    const MotionVector x_ref = random.Parameters(0.6);
    const MotionVector expected = random.Parameters(0.9);
    // The pose from which the motion has the parameters `expected`.
    const Rigid3d cur_from_world =
        motion.CurFromPrev(expected.data()) * ref.CurFromPrev(x_ref.data());
    const MotionVector x_cur = random.Parameters(0.5);
    MotionVector only_turn = x_cur;
    only_turn.tail<3>().setZero();
    const Rigid3d turned = MotionOrigin().CurFromPrev(only_turn.data());
    const MotionOrigin cur(
        Rigid3d(turned.rotation.conjugate() * cur_from_world.rotation,
                Eigen::Vector3d::Zero()));
    MotionVector at_cur = x_cur;
    at_cur.tail<3>() = cur_from_world.Inverse().translation;

    const Evaluated hand =
        At(LiveBlock(&parameters, &motion, &ref, &cur, /*by_jet=*/false), x_ref,
           at_cur);
    const Evaluated jet =
        At(LiveBlock(&parameters, &motion, &ref, &cur, /*by_jet=*/true), x_ref,
           at_cur);
    EXPECT_TRUE(hand.residuals.isApprox(expected, 1e-9))
        << hand.residuals.transpose() << "\n"
        << expected.transpose();
    EXPECT_TRUE(jet.residuals.isApprox(expected, 1e-9));
    for (int pose = 0; pose < 2; ++pose) {
      EXPECT_TRUE(hand.jacobians[pose].isApprox(jet.jacobians[pose], 1e-9))
          << hand.jacobians[pose] << "\n\n"
          << jet.jacobians[pose];
    }
    // Both go the same way to the end: so does a small step.
    const LiveBlock block(&parameters, &motion, &ref, &cur, /*by_jet=*/false);
    const MotionVector step = random.Parameters(1e-6);
    const MotionVector change = At(block, x_ref + step, at_cur).residuals -
                                At(block, x_ref - step, at_cur).residuals;
    EXPECT_TRUE(change.isApprox(2.0 * hand.jacobians[0] * step, 1e-6));
  }
}

// An edge that is off by anything below a half turn: 2 sin(angle / 2) about the
// axis, not its opposite.
TEST(EdgeBlockTest, GrowsUpToAHalfTurn) {
  Randoms random(2);
  for (const double angle : {0.01, 1.0, 2.0, 2.6, 3.1}) {
    for (int i = 0; i < 20; ++i) {
      const MotionOrigin ref(random.Motion(0.5)), cur(random.Motion(2.0));
      const MotionVector zero = MotionVector::Zero();
      const Rigid3d cur_from_ref =
          cur.CurFromPrev(zero.data()) * ref.CurFromPrev(zero.data()).Inverse();
      const Eigen::Vector3d axis = random.Vector().normalized();
      const Rigid3d measured(
          Eigen::Quaterniond(Eigen::AngleAxisd(-angle, axis)) *
              cur_from_ref.rotation,
          cur_from_ref.translation);
      const EdgeTerm term = EdgeTerm::Of(measured, MotionMatrix::Identity());
      const Evaluated hand = At(EdgeBlock(term, &ref, &cur), zero, zero);
      EXPECT_TRUE(hand.residuals.head<3>().isApprox(
          2.0 * std::sin(angle / 2.0) * axis, 1e-7))
          << angle << ": " << hand.residuals.transpose() << ", axis "
          << axis.transpose();
      const std::unique_ptr<ceres::CostFunction> oracle(
          MakeEdgeOracle(term, &ref, &cur));
      const Evaluated jet = At(*oracle, zero, zero);
      for (int pose = 0; pose < 2; ++pose) {
        EXPECT_TRUE(hand.jacobians[pose].isApprox(jet.jacobians[pose], 1e-6))
            << angle;
      }
    }
  }
}

TEST(SquareRootOfTest, GivesTheInformationBack) {
  Randoms random(3);
  MotionMatrix half;
  for (int i = 0; i < 6; ++i) half.col(i) = random.Parameters(1.0);
  half.topRows<3>() *= 1e4;  // rad^-1 beside m^-1
  MotionMatrix information = half * half.transpose();
  MotionMatrix root = SquareRootOf(information);
  EXPECT_TRUE((root.transpose() * root).isApprox(information, 1e-12));

  information.row(2).setZero();
  information.col(2).setZero();
  root = SquareRootOf(information);
  EXPECT_TRUE((root.transpose() * root).isApprox(information, 1e-12));

  information(2, 2) = -1.0;
  EXPECT_TRUE(SquareRootOf(information).hasNaN());
}

}  // namespace
}  // namespace rgbd_pose
