// The residual blocks that a graph passes to Ceres, far from the initial poses.

#include "core/pose_graph/graph_problem.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/support/edge_oracle.h"

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

// For any edge error below a half turn, the residual is 2 sin(angle / 2) along
// the axis, not along the opposite axis.
TEST(EdgeBlockTest, GrowsUpToAHalfTurn) {
  Randoms random(2);
  for (const double angle : {0.01, 1.0, 2.0, 2.6, 3.1}) {
    for (int i = 0; i < 20; ++i) {
      const LinearizationPoint ref(random.Motion(0.5)), cur(random.Motion(2.0));
      const MotionVector zero = MotionVector::Zero();
      const Rigid3d cur_from_ref =
          cur.CurFromPrev(zero.data()) * ref.CurFromPrev(zero.data()).Inverse();
      const Eigen::Vector3d axis = random.Vector().normalized();
      const Rigid3d measured(
          Eigen::Quaterniond(Eigen::AngleAxisd(-angle, axis)) *
              cur_from_ref.rotation,
          cur_from_ref.translation);
      const RelativePoseErrorTerm term(measured, MotionMatrix::Identity());
      const Evaluated hand = At(EdgeBlock(term, &ref, &cur), zero, zero);
      EXPECT_TRUE(hand.residuals.head<3>().isApprox(
          2.0 * std::sin(angle / 2.0) * axis, 1e-7))
          << angle << ": " << hand.residuals.transpose() << ", axis "
          << axis.transpose();
      const auto oracle = MakeEdgeOracle(term, &ref, &cur);
      const Evaluated jet = At(*oracle, zero, zero);
      for (int pose = 0; pose < 2; ++pose) {
        EXPECT_TRUE(hand.jacobians[pose].isApprox(jet.jacobians[pose], 1e-6))
            << angle;
      }
    }
  }
}

TEST(SqrtInformationTest, GivesTheInformationBack) {
  Randoms random(3);
  MotionMatrix half;
  for (int i = 0; i < 6; ++i) half.col(i) = random.Parameters(1.0);
  half.topRows<3>() *= 1e4;  // rad^-1 and m^-1
  MotionMatrix information = half * half.transpose();
  MotionMatrix root = SqrtInformation(information);
  EXPECT_TRUE((root.transpose() * root).isApprox(information, 1e-12));

  information.row(2).setZero();
  information.col(2).setZero();
  root = SqrtInformation(information);
  EXPECT_TRUE((root.transpose() * root).isApprox(information, 1e-12));

  information(2, 2) = -1.0;
  EXPECT_TRUE(SqrtInformation(information).hasNaN());
}

}  // namespace
}  // namespace rgbd_pose
