// Compares the normal equations of a bundle adjustment, built landmark by
// landmark, with dense ones by ceres::Jet from which all depths are eliminated
// at once. Also tests the covariance of the camera that follows from them.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/factors/check_factor.h"
#include "core/factors/factor.h"
#include "costs/calibration/bundle_adjustment.h"
#include "costs/calibration/landmark_factors.h"
#include "costs/calibration/scaled_distance.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr int kKeyframes = 4;
constexpr int kLandmarks = 12;
constexpr double kLossWidth = kLandmarkLossWidth;

MeasuredInverseDepth SomeDepth(RandomWorld* world) {
  MeasuredInverseDepth depth;
  depth.value = world->Uniform(0.3, 0.6);
  depth.inverse_sigma = world->Uniform(100.0, 300.0);
  depth.plane = world->Vector(0.3) + Eigen::Vector3d::UnitZ();
  depth.ray = world->Vector(0.4);
  depth.ray.z() = 1.0;
  return depth;
}

// Keyframes around a wall and their views of it, with small inconsistencies.
struct Problem {
  CalibrationViews views;
  CalibrationState state;
  CalibrationOrigin origin;

  std::shared_ptr<const CalibrationModel> Model() const {
    return ModelOf(views, origin);
  }

  // Each keyframe is the anchor of some landmarks, or `anchor` is of all.
  explicit Problem(std::optional<int> anchor = std::nullopt) {
    RandomWorld world(11);
    for (int k = 0; k < kKeyframes; ++k) {
      state.world_from_cam.push_back(world.Motion(0.1, 0.2));
      views.twists.push_back({world.Vector(0.5), world.Vector(0.5)});
    }
    origin.start << 525.0, 520.0, 319.5, 239.5, 0.05, -0.02, 0.03, 0.01, 0.002,
        -0.003, 0.01, 0.01, 0.02, 0.03, 0.01, 0.02, -0.01, 0.01, 0.02, 0.01,
        1.02;
    for (double& width : origin.width) width = world.Uniform(0.5, 2.0);
    state.theta = origin.start;
    state.pixel_scale = 1.3;
    state.depth_scale = 0.8;
    for (int i = 0; i < kLandmarks; ++i) {
      Landmark landmark;
      landmark.anchor = anchor.value_or(i % kKeyframes);
      landmark.u = world.Uniform(100.0, 540.0);
      landmark.v = world.Uniform(100.0, 380.0);
      landmark.depth = SomeDepth(&world);
      landmark.first_view = static_cast<int>(views.views.size());
      for (int k = 0; k < kKeyframes; ++k) {
        if (k == landmark.anchor || (i + k) % 3 == 0) continue;
        LandmarkView view;
        view.keyframe = k;
        view.u = landmark.u + world.Uniform(-9.0, 9.0);
        view.v = landmark.v + world.Uniform(-9.0, 9.0);
        view.sigma_px = world.Uniform(0.5, 2.0);
        view.is_held_out = (i + k) % 4 == 0;
        if (k % 2 == 0) view.depth = SomeDepth(&world);
        views.views.push_back(view);
        ++landmark.num_views;
      }
      views.landmarks.push_back(landmark);
      state.inverse_depths.push_back(world.Uniform(0.3, 0.6));
    }
  }
};

// The derivatives of a factor in the tangents of its blocks by ceres::Jet, one
// above another: a row for each direction.
template <typename Factor>
Eigen::MatrixXd TangentsByJets(const Factor& factor,
                               const std::vector<const double*>& x, double* r) {
  const std::unique_ptr<ceres::CostFunction> jets(MakeAutodiffFactor(factor));
  const auto kinds = factors::KindsOf(typename Factor::Blocks());
  std::vector<std::vector<double>> by;
  std::vector<double*> pointers;
  int directions = 0;
  for (const factors::BlockKind& kind : kinds) {
    by.emplace_back(kind.size * Factor::kRows);
    directions += kind.tangent;
  }
  for (std::vector<double>& block : by) pointers.push_back(block.data());
  EXPECT_TRUE(jets->Evaluate(x.data(), r, pointers.data()));
  Eigen::MatrixXd all(directions, Factor::kRows);
  int at = 0;
  for (size_t i = 0; i < kinds.size(); ++i) {
    const Eigen::Map<const Eigen::MatrixXd> transposed(
        by[i].data(), kinds[i].size, Factor::kRows);
    all.middleRows(at, kinds[i].tangent) =
        kinds[i].plus_jacobian(x[i]).transpose() * transposed;
    at += kinds[i].tangent;
  }
  return all;
}

// All unknowns: poses except the first, y, and the depths.
class DenseEquations {
 public:
  explicit DenseEquations(const Problem& problem)
      : problem_(problem), model_(problem.Model()) {
    for (const Rigid3d& pose : problem.state.world_from_cam) {
      poses_.push_back(PoseVectorOf(pose));
    }
    kept_ = 6 * (kKeyframes - 1) + kCalibrationSize;
    H = Eigen::MatrixXd::Zero(kept_ + kLandmarks, kept_ + kLandmarks);
    g = Eigen::MatrixXd::Zero(kept_ + kLandmarks, kKeyframes);
  }

  // A residual of a view.
  template <typename Factor>
  void Add(int landmark, int anchor, int keyframe, const LandmarkData& data) {
    Eigen::Matrix<double, Factor::kRows, 1> r;
    const Eigen::MatrixXd by =
        TangentsByJets(Factor{model_, data},
                       {poses_[anchor].data(), poses_[keyframe].data(),
                        &problem_.state.inverse_depths[landmark], y_.data()},
                       r.data());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(H.cols(), Factor::kRows);
    if (anchor > 0) J.middleRows<6>(6 * (anchor - 1)) += by.topRows<6>();
    if (keyframe > 0) {
      J.middleRows<6>(6 * (keyframe - 1)) += by.middleRows<6>(6);
    }
    J.row(kept_ + landmark) = by.row(12);
    J.middleRows<kCalibrationSize>(kept_ - kCalibrationSize) =
        by.bottomRows<kCalibrationSize>();
    AddRows<Factor::kRows>(anchor, J.transpose(), r);
  }

  // The residual of an anchor.
  void AddAnchor(int landmark, int anchor, const LandmarkData& data) {
    Eigen::Matrix<double, 1, 1> r;
    const Eigen::MatrixXd by = TangentsByJets(
        AnchorDepthFactor{model_, data},
        {&problem_.state.inverse_depths[landmark], y_.data()}, r.data());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(H.cols(), 1);
    J.row(kept_ + landmark) = by.row(0);
    J.middleRows<kCalibrationSize>(kept_ - kCalibrationSize) =
        by.bottomRows<kCalibrationSize>();
    AddRows<1>(anchor, J.transpose(), r);
  }

  // Depths without residuals are left out.
  void EliminateDepths() {
    for (int i = kLandmarks - 1; i >= 0; --i) {
      const int last = kept_ + i;
      const double pivot = H(last, last);
      if (pivot > 0.0) {
        const Eigen::VectorXd column = H.col(last);
        const Eigen::RowVectorXd rest = g.row(last);
        H -= column * column.transpose() / pivot;
        g -= column * rest / pivot;
      }
    }
    H.conservativeResize(kept_, kept_);
    g.conservativeResize(kept_, kKeyframes);
  }

  Eigen::MatrixXd H, g;
  double slope_p = 0.0, weight_p = 0.0;

 private:
  template <int kRows>
  void AddRows(int anchor, const Eigen::MatrixXd& J,
               const Eigen::Matrix<double, kRows, 1>& r) {
    const double weight =
        1.0 / (1.0 + r.squaredNorm() / (kLossWidth * kLossWidth));
    // Derivative of the loss's influence along the residual, by differences.
    const auto pull = [](double s) {
      return std::sqrt(s) / (1.0 + s / (kLossWidth * kLossWidth));
    };
    const double norm = r.norm(), step = 1e-5;
    slope_p += (kRows - 1) * weight + (pull(std::pow(norm + step, 2)) -
                                       pull(std::pow(norm - step, 2))) /
                                          (2.0 * step);
    weight_p += kRows * weight;
    H += weight * J.transpose() * J;
    g.col(anchor) += weight * J.transpose() * r;
  }

  const Problem& problem_;
  const std::shared_ptr<const CalibrationModel> model_;
  const CalibrationVector y_ = CalibrationVector::Zero();
  std::vector<PoseVector> poses_;
  int kept_ = 0;
};

TEST(ReducedCameraSystemTest, AreThoseOfAllUnknownsWithoutTheDepths) {
  const Problem problem;
  for (const bool training_only : {false, true}) {
    DenseEquations dense(problem);
    for (int i = 0; i < kLandmarks; ++i) {
      const Landmark& landmark = problem.views.landmarks[i];
      bool is_seen = false;
      for (int k = 0; k < landmark.num_views; ++k) {
        const LandmarkView& view = problem.views.views[landmark.first_view + k];
        if (!view.TakesPart(training_only)) continue;
        is_seen = true;
        const LandmarkData data =
            DataOf(problem.views, landmark, view, problem.state);
        dense.Add<LandmarkPixelFactor>(i, landmark.anchor, view.keyframe, data);
        if (view.depth.inverse_sigma > 0.0) {
          dense.Add<LandmarkDepthFactor>(i, landmark.anchor, view.keyframe,
                                         data);
        }
      }
      if (!is_seen) continue;
      dense.AddAnchor(i, landmark.anchor,
                      DataOf(problem.views, landmark, problem.state));
    }
    dense.EliminateDepths();
    const ReducedCameraSystem equations = MakeReducedCameraSystem(
        problem.views, training_only, problem.origin, problem.state);
    const Eigen::MatrixXd lower =
        equations.hessian.triangularView<Eigen::Lower>();
    const Eigen::MatrixXd expected = dense.H.triangularView<Eigen::Lower>();
    EXPECT_TRUE(lower.isApprox(expected, 1e-9))
        << (lower - expected).cwiseAbs().maxCoeff() << " of "
        << expected.cwiseAbs().maxCoeff();
    EXPECT_NEAR(equations.slope_p, dense.slope_p, 1e-6 * dense.weight_p);
    EXPECT_NEAR(equations.weight_p, dense.weight_p, 1e-9 * dense.weight_p);
    EXPECT_TRUE(equations.gradients.isApprox(dense.g, 1e-9))
        << (equations.gradients - dense.g).cwiseAbs().maxCoeff();
  }
}

// By formula, with whole matrices: the inverse of all information, and the
// sandwich with slopes and with the gradient of each keyframe's landmarks.
// `correction` is the factor for a small number of keyframes.
void ExpectInverseAndSandwich(Problem problem, double correction) {
  RandomWorld world(12);
  for (const int a : {0, 1, 2}) {
    KnownDistance known;
    known.a = a;
    known.b = (a + 2) % kKeyframes;
    known.in_a = world.Vector(1.0);
    known.in_b = world.Vector(1.0);
    known.metres = 0.5;
    known.sigma = 0.05;
    problem.views.distances.push_back(known);
  }
  const ReducedCameraSystem equations = MakeReducedCameraSystem(
      problem.views, /*training_only=*/true, problem.origin, problem.state);
  const int y_at = equations.PlaceOfY();

  Eigen::MatrixXd exact =
      Eigen::MatrixXd::Zero(equations.hessian.rows(), equations.hessian.cols());
  exact.bottomRightCorner<kCalibrationSize, kCalibrationSize>().setIdentity();
  const CalibrationVector y = CalibrationVector::Zero();
  for (const KnownDistance& known : problem.views.distances) {
    const PoseVector a = PoseVectorOf(problem.state.world_from_cam[known.a]);
    const PoseVector b = PoseVectorOf(problem.state.world_from_cam[known.b]);
    double residual;
    const Eigen::VectorXd by =
        TangentsByJets(ScaledDistanceFactor{problem.Model(), known},
                       {a.data(), b.data(), y.data()}, &residual);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(exact.rows());
    if (known.a > 0) row.segment<6>(6 * (known.a - 1)) += by.head<6>();
    if (known.b > 0) row.segment<6>(6 * (known.b - 1)) += by.segment<6>(6);
    row.tail<kCalibrationSize>() += by.tail<kCalibrationSize>();
    exact += row * row.transpose();
  }
  const Eigen::MatrixXd H =
      Eigen::MatrixXd(equations.hessian.selfadjointView<Eigen::Lower>()) +
      exact;
  const Eigen::MatrixXd inverse = H.inverse();
  const double slope = std::max(0.2, equations.slope_p / equations.weight_p);
  const Eigen::MatrixXd with_slope =
      (slope * H + (1.0 - slope) * exact).inverse();
  const Eigen::MatrixXd pull =
      correction * equations.gradients * equations.gradients.transpose() +
      exact;
  const auto width = problem.origin.width.asDiagonal();
  const CalibrationMatrix expected_noise =
      width * inverse.block(y_at, y_at, kCalibrationSize, kCalibrationSize) *
      width;
  const CalibrationMatrix expected_scatter =
      width *
      (with_slope * pull * with_slope)
          .block(y_at, y_at, kCalibrationSize, kCalibrationSize) *
      width;

  CalibrationMatrix model_covariance, sandwich_covariance;
  ASSERT_TRUE(LandmarkCovariance(problem.views, /*training_only=*/true,
                                 problem.origin, problem.state,
                                 &model_covariance, &sandwich_covariance));
  EXPECT_TRUE(model_covariance.isApprox(expected_noise, 1e-6));
  EXPECT_TRUE(sandwich_covariance.isApprox(expected_scatter, 1e-6));
}

TEST(LandmarkCovarianceTest, IsTheInverseAndTheSandwich) {
  ExpectInverseAndSandwich(Problem(), kKeyframes / (kKeyframes - 1.0));
}

// The landmarks of a single keyframe do not show any scatter between keyframes.
TEST(LandmarkCovarianceTest, OneGroupIsNotCorrected) {
  ExpectInverseAndSandwich(Problem(/*anchor=*/1), 1.0);
}

TEST(CalibrationStateTest, RowsAreSharesOfTheReadout) {
  const Problem problem;
  const double height = problem.views.camera.height;
  const double row = 1.0 / height;
  EXPECT_NEAR(MotionAt(problem.views, 1, 0.0).row, -0.5, row);
  EXPECT_NEAR(MotionAt(problem.views, 1, height - 1.0).row, 0.5, row);
  EXPECT_EQ(MotionAt(problem.views, 1, 0.0).twist.linear,
            problem.views.twists[1].linear);
}

// Sigmas are scaled by the scales in the state.
TEST(CalibrationStateTest, ScalesSigmas) {
  const Problem problem;
  const Landmark& landmark = problem.views.landmarks[0];
  const LandmarkView& view = problem.views.views[landmark.first_view];
  const LandmarkData data =
      DataOf(problem.views, landmark, view, problem.state);
  EXPECT_DOUBLE_EQ(data.inverse_sigma_px, 1.0 / (1.3 * view.sigma_px));
  EXPECT_DOUBLE_EQ(data.depth.inverse_sigma, view.depth.inverse_sigma / 0.8);
  EXPECT_DOUBLE_EQ(
      DataOf(problem.views, landmark, problem.state).depth.inverse_sigma,
      landmark.depth.inverse_sigma / 0.8);
}

}  // namespace
}  // namespace rgbd_pose
