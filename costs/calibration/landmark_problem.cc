#include "costs/calibration/landmark_problem.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "costs/calibration/calibration_list.h"
#include "costs/calibration/known_distance_block.h"

namespace rgbd_pose {
namespace {

using FreeParts = std::array<bool, kCalibrationSize>;

// The prior of y: as it is counted in its standard deviations.
class PriorBlock final
    : public ceres::SizedCostFunction<kCalibrationSize, kCalibrationSize> {
 public:
  bool Evaluate(double const* const* y, double* residuals,
                double** jacobians) const override {
    for (int i = 0; i < kCalibrationSize; ++i) {
      residuals[i] = y[0][i];
      if (jacobians == nullptr || jacobians[0] == nullptr) continue;
      for (int k = 0; k < kCalibrationSize; ++k) {
        jacobians[0][i * kCalibrationSize + k] = i == k ? 1.0 : 0.0;
      }
    }
    return true;
  }
};

std::vector<MotionOrigin> OriginsOf(
    const std::vector<Rigid3d>& world_from_cam) {
  std::vector<MotionOrigin> origins;
  for (const Rigid3d& pose : world_from_cam) {
    origins.emplace_back(pose.Inverse());
  }
  return origins;
}

// rho' of Cauchy's loss.
double Weight(double squared, double width) {
  return 1.0 / (1.0 + squared / (width * width));
}

}  // namespace

LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const CalibrationState& state) {
  LandmarkData data;
  data.rest = &views.camera;
  data.anchor_u = landmark.u;
  data.anchor_v = landmark.v;
  data.depth = landmark.depth;
  data.depth.inverse_sigma /= state.depth_scale;
  return data;
}

LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const LandmarkView& view, const CalibrationState& state) {
  LandmarkData data = DataOf(views, landmark, state);
  data.u = view.u;
  data.v = view.v;
  data.inverse_sigma_px = 1.0 / (view.sigma_px * state.pixel_scale);
  data.depth = view.depth;
  data.depth.inverse_sigma /= state.depth_scale;
  return data;
}

LandmarkProblem::LandmarkProblem(const CalibrationViews& views,
                                 const CalibrationVector& start,
                                 const CalibrationVector& prior,
                                 bool training_only,
                                 const LandmarkProblemOptions& options)
    : views_(views),
      start_(start),
      prior_(prior),
      training_only_(training_only),
      options_(options) {}

CalibrationState LandmarkProblem::Begin() const {
  CalibrationState state;
  state.world_from_cam = views_.world_from_cam;
  state.theta = start_;
  for (const Landmark& landmark : views_.landmarks) {
    state.inverse_depths.push_back(landmark.depth.value);
  }
  return state;
}

CalibrationOrigin LandmarkProblem::OriginOf(const FreeParts& is_free) const {
  CalibrationOrigin origin{start_, prior_};
  for (int k = 0; k < kCalibrationSize; ++k) {
    if (!is_free[k]) origin.width[k] = 0.0;
  }
  return origin;
}

void LandmarkProblem::MeasureScales(CalibrationState* state) const {
  const auto origins = OriginsOf(state->world_from_cam);
  std::vector<MotionDerivatives> poses;
  const MotionVector zero = MotionVector::Zero();
  for (const MotionOrigin& origin : origins) {
    poses.push_back(origin.DerivativesAt(zero.data()));
  }
  state->pixel_scale = state->depth_scale = 1.0;
  std::vector<double> pixels, depths;
  double r[2];
  for (size_t i = 0; i < views_.landmarks.size(); ++i) {
    const Landmark& landmark = views_.landmarks[i];
    const double d = state->inverse_depths[i];
    const MotionPose<double>& anchor = poses[landmark.anchor];
    AnchorDepth::Residual<double>(anchor, anchor, d, state->theta.data(),
                                  DataOf(views_, landmark, *state), r);
    depths.push_back(std::abs(r[0]));
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views_.views[landmark.first_view + k];
      if (!TakesPart(view)) continue;
      const LandmarkData data = DataOf(views_, landmark, view, *state);
      const MotionPose<double>& there = poses[view.keyframe];
      LandmarkPixel::Residual<double>(anchor, there, d, state->theta.data(),
                                      data, r);
      pixels.push_back(std::abs(r[0]));
      pixels.push_back(std::abs(r[1]));
      if (data.depth.inverse_sigma == 0.0) continue;
      LandmarkDepth::Residual<double>(anchor, there, d, state->theta.data(),
                                      data, r);
      depths.push_back(std::abs(r[0]));
    }
  }
  constexpr double kSigmaOfMedian = 1.4826;  // of a normal distribution
  constexpr double kLeast = 1e-3;
  const auto scale_of = [&](std::vector<double>* values) {
    if (values->empty()) return 1.0;
    const auto middle = values->begin() + values->size() / 2;
    std::nth_element(values->begin(), middle, values->end());
    return std::max(kLeast, kSigmaOfMedian * *middle);
  };
  state->pixel_scale = scale_of(&pixels);
  state->depth_scale = scale_of(&depths);
}

double LandmarkProblem::Solve(const FreeParts& is_free,
                              CalibrationState* state) const {
  const CalibrationOrigin origin = OriginOf(is_free);
  const std::vector<MotionOrigin> origins = OriginsOf(state->world_from_cam);
  std::vector<MotionVector> x(origins.size(), MotionVector::Zero());
  CalibrationVector y;
  for (int k = 0; k < kCalibrationSize; ++k) {
    y[k] = is_free[k] ? (state->theta[k] - start_[k]) / prior_[k] : 0.0;
  }
  const size_t num_landmarks = views_.landmarks.size();
  std::vector<LandmarkData> data;  // stays where it is
  data.reserve(num_landmarks + views_.views.size());

  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss loss(options_.loss_width);
  ceres::Problem problem(ownership);
  ceres::Solver::Options options;
  options.linear_solver_ordering.reset(new ceres::ParameterBlockOrdering);
  for (size_t i = 0; i < num_landmarks; ++i) {
    const Landmark& landmark = views_.landmarks[i];
    double* const anchor = x[landmark.anchor].data();
    double* const d = &state->inverse_depths[i];
    // Any pose will do: its own depth does not depend on it.
    data.push_back(DataOf(views_, landmark, *state));
    int used = 0;
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views_.views[landmark.first_view + k];
      if (!TakesPart(view)) continue;
      if (used++ == 0) {
        problem.AddResidualBlock(
            new LandmarkBlock<AnchorDepth>(origins[landmark.anchor],
                                           origins[view.keyframe], origin,
                                           data.back()),
            &loss, anchor, x[view.keyframe].data(), d, y.data());
      }
      data.push_back(DataOf(views_, landmark, view, *state));
      problem.AddResidualBlock(new LandmarkBlock<LandmarkPixel>(
                                   origins[landmark.anchor],
                                   origins[view.keyframe], origin, data.back()),
                               &loss, anchor, x[view.keyframe].data(), d,
                               y.data());
      if (view.depth.inverse_sigma == 0.0) continue;
      problem.AddResidualBlock(new LandmarkBlock<LandmarkDepth>(
                                   origins[landmark.anchor],
                                   origins[view.keyframe], origin, data.back()),
                               &loss, anchor, x[view.keyframe].data(), d,
                               y.data());
    }
    if (used > 0) options.linear_solver_ordering->AddElementToGroup(d, 0);
  }
  for (const KnownDistance& known : views_.distances) {
    problem.AddResidualBlock(
        new KnownDistanceBlock(origins[known.a], origins[known.b], origin,
                               known),
        nullptr, x[known.a].data(), x[known.b].data(), y.data());
  }
  problem.AddResidualBlock(new PriorBlock, nullptr, y.data());
  options.linear_solver_ordering->AddElementToGroup(y.data(), 1);
  for (MotionVector& pose : x) {
    if (!problem.HasParameterBlock(pose.data())) continue;
    options.linear_solver_ordering->AddElementToGroup(pose.data(), 1);
  }
  if (problem.HasParameterBlock(x[0].data())) {
    problem.SetParameterBlockConstant(x[0].data());
  }
  if (std::none_of(is_free.begin(), is_free.end(), [](bool b) { return b; })) {
    problem.SetParameterBlockConstant(y.data());
  }

  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = options_.max_iterations;
  options.num_threads = options_.threads;
  options.function_tolerance = 1e-5;
  options.initial_trust_region_radius = 1e6;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  for (size_t i = 0; i < x.size(); ++i) {
    state->world_from_cam[i] = origins[i].CurFromPrev(x[i].data()).Inverse();
  }
  state->theta = origin.At(y.data());
  return summary.final_cost;
}

bool LandmarkProblem::Covariance(const FreeParts& is_free,
                                 const CalibrationState& state,
                                 CalibrationMatrix* by_noise,
                                 CalibrationMatrix* by_scatter) const {
  by_noise->setZero();
  by_scatter->setZero();
  const CalibrationOrigin origin = OriginOf(is_free);
  const auto origins = OriginsOf(state.world_from_cam);
  std::vector<MotionDerivatives> poses;
  const MotionVector zero = MotionVector::Zero();
  for (const MotionOrigin& at : origins) {
    poses.push_back(at.DerivativesAt(zero.data()));
  }
  // Unknowns: all poses but the first, then y.
  const int num_poses = static_cast<int>(poses.size());
  const int size = 6 * (num_poses - 1) + kCalibrationSize;
  const int y_at = size - kCalibrationSize;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  // The gradient of the landmarks of each anchor, after the landmarks' depths
  // have been eliminated.
  Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(size, num_poses);
  const double width = options_.loss_width;

  Eigen::MatrixXd local;     // [anchor, y, views], the lower triangle
  Eigen::VectorXd by_depth;  // with the landmark's own depth
  Eigen::VectorXd gradient;
  std::vector<int> at;  // where the blocks are in H; -1: the first pose
  for (size_t i = 0; i < views_.landmarks.size(); ++i) {
    const Landmark& landmark = views_.landmarks[i];
    const double d = state.inverse_depths[i];
    const MotionDerivatives& anchor = poses[landmark.anchor];
    constexpr int kFixed = 6 + kCalibrationSize;
    const int rows = kFixed + 6 * landmark.num_views;
    local.setZero(rows, rows);
    by_depth.setZero(rows);
    gradient.setZero(rows);
    double hessian_d = 0.0, gradient_d = 0.0;
    int used = 0;
    at.assign(1, landmark.anchor);
    const auto add = [&](const auto& J, const auto& r, double weight, int view,
                         bool has_poses) {
      constexpr int kRows = std::decay_t<decltype(r)>::RowsAtCompileTime;
      Eigen::Matrix<double, kRows, kFixed> head;
      head << J.anchor, J.theta * origin.width.asDiagonal();
      local.topLeftCorner<kFixed, kFixed>().noalias() +=
          weight * head.transpose() * head;
      by_depth.head<kFixed>() += weight * head.transpose() * J.inverse_depth;
      gradient.head<kFixed>() += weight * head.transpose() * r;
      hessian_d += weight * J.inverse_depth.squaredNorm();
      gradient_d += weight * J.inverse_depth.dot(r);
      if (!has_poses) return;
      const int place = kFixed + 6 * view;
      local.block<6, kFixed>(place, 0).noalias() +=
          weight * J.view.transpose() * head;
      local.block<6, 6>(place, place).noalias() +=
          weight * J.view.transpose() * J.view;
      by_depth.segment<6>(place) +=
          weight * J.view.transpose() * J.inverse_depth;
      gradient.segment<6>(place) += weight * J.view.transpose() * r;
    };
    Eigen::Matrix<double, 1, 1> r1;
    Eigen::Vector2d r2;
    LandmarkDerivatives<1> J1;
    LandmarkDerivatives<2> J2;
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views_.views[landmark.first_view + k];
      if (!TakesPart(view)) continue;
      const LandmarkData data = DataOf(views_, landmark, view, state);
      const MotionDerivatives& there = poses[view.keyframe];
      at.push_back(view.keyframe);
      LandmarkPixel::Jacobian(anchor, there, d, state.theta.data(), data,
                              r2.data(), &J2);
      add(J2, r2, Weight(r2.squaredNorm(), width), used, true);
      if (data.depth.inverse_sigma > 0.0) {
        LandmarkDepth::Jacobian(anchor, there, d, state.theta.data(), data,
                                r1.data(), &J1);
        add(J1, r1, Weight(r1.squaredNorm(), width), used, true);
      }
      ++used;
    }
    if (used == 0) continue;
    AnchorDepth::Jacobian(anchor, anchor, d, state.theta.data(),
                          DataOf(views_, landmark, state), r1.data(), &J1);
    add(J1, r1, Weight(r1.squaredNorm(), width), 0, false);
    if (!(hessian_d > 0.0)) continue;

    // Without d, which is at its best whatever the rest is.
    const int length = kFixed + 6 * used;
    local.topLeftCorner(length, length)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(by_depth.head(length), -1.0 / hessian_d);
    gradient.head(length) -= by_depth.head(length) * (gradient_d / hessian_d);
    // Blocks of six or of y: local place, size, place in H.
    const auto place_of = [&](int block, int* from, int* count, int* to) {
      if (block == 0) {
        *from = 0, *count = 6, *to = 6 * (at[0] - 1);
      } else if (block == 1) {
        *from = 6, *count = kCalibrationSize, *to = y_at;
      } else {
        *from = kFixed + 6 * (block - 2), *count = 6;
        *to = 6 * (at[block - 1] - 1);
      }
    };
    for (int a = 0; a < used + 2; ++a) {
      int from_a, count_a, to_a;
      place_of(a, &from_a, &count_a, &to_a);
      if (to_a < 0) continue;
      gradients.col(landmark.anchor).segment(to_a, count_a) +=
          gradient.segment(from_a, count_a);
      for (int b = 0; b <= a; ++b) {
        int from_b, count_b, to_b;
        place_of(b, &from_b, &count_b, &to_b);
        if (to_b < 0) continue;
        const auto block = local.block(from_a, from_b, count_a, count_b);
        if (to_a > to_b) {
          H.block(to_a, to_b, count_a, count_b) += block;
        } else if (to_a < to_b) {
          H.block(to_b, to_a, count_b, count_a) += block.transpose();
        } else {
          H.block(to_a, to_a, count_a, count_a)
              .triangularView<Eigen::Lower>() += block;
        }
      }
    }
  }
  for (const KnownDistance& known : views_.distances) {
    const KnownDistanceError error(poses[known.a], poses[known.b],
                                   state.theta[kDepthFactor], known);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    if (known.a > 0) row.segment<6>(6 * (known.a - 1)) += error.a.transpose();
    if (known.b > 0) row.segment<6>(6 * (known.b - 1)) += error.b.transpose();
    row[y_at + kDepthFactor] += error.by_factor * origin.width[kDepthFactor];
    H.noalias() += row * row.transpose();
  }
  for (int k = 0; k < kCalibrationSize; ++k) H(y_at + k, y_at + k) += 1.0;
  // Poses that nothing sees.
  for (int k = 0; k < y_at; ++k) H(k, k) += 1e-9;

  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> cholesky(H);
  if (cholesky.info() != Eigen::Success) return false;
  Eigen::MatrixXd last = Eigen::MatrixXd::Zero(size, kCalibrationSize);
  last.bottomRows<kCalibrationSize>().setIdentity();
  cholesky.solveInPlace(last);
  const auto scale = origin.width.asDiagonal();
  *by_noise = scale * last.bottomRows<kCalibrationSize>() * scale;
  // What each keyframe's landmarks move y by.
  Eigen::MatrixXd moves = last.transpose() * gradients;
  // Distances and the prior have the noise that they say.
  CalibrationMatrix exact = last.bottomRows<kCalibrationSize>().transpose() *
                            last.bottomRows<kCalibrationSize>();
  for (const KnownDistance& known : views_.distances) {
    const KnownDistanceError error(poses[known.a], poses[known.b],
                                   state.theta[kDepthFactor], known);
    CalibrationVector move = last.row(y_at + kDepthFactor).transpose() *
                             error.by_factor * origin.width[kDepthFactor];
    if (known.a > 0) {
      move += last.middleRows<6>(6 * (known.a - 1)).transpose() *
              error.a.transpose();
    }
    if (known.b > 0) {
      move += last.middleRows<6>(6 * (known.b - 1)).transpose() *
              error.b.transpose();
    }
    exact += move * move.transpose();
  }
  int groups = 0;
  for (int k = 0; k < num_poses; ++k) groups += moves.col(k).norm() > 0.0;
  const double correction =
      groups > 1 ? static_cast<double>(groups) / (groups - 1) : 1.0;
  *by_scatter =
      scale * (correction * moves * moves.transpose() + exact) * scale;
  return by_noise->allFinite() && by_scatter->allFinite();
}

}  // namespace rgbd_pose
