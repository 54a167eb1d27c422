#include "costs/calibration/bundle_adjustment.h"

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/factor.h"
#include "core/factors/pose_manifold.h"
#include "core/util/quantile.h"
#include "costs/calibration/landmark_factors.h"
#include "costs/calibration/scaled_distance.h"

namespace rgbd_pose {
namespace {

// Reports iterations. An exception must not pass through the solver.
class IterationReport : public ceres::IterationCallback {
 public:
  explicit IterationReport(const std::function<void()>& report)
      : report_(report) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& /*summary*/) override {
    try {
      if (report_) report_();
      return ceres::SOLVER_CONTINUE;
    } catch (...) {
      thrown_ = std::current_exception();
      return ceres::SOLVER_ABORT;
    }
  }

  // To be called after the solver ended.
  void PassOn() const {
    if (thrown_ != nullptr) std::rethrow_exception(thrown_);
  }

 private:
  const std::function<void()>& report_;
  std::exception_ptr thrown_;
};

// The problem that Ceres solves.
class AdjustmentProblem {
 public:
  // `views` and `state` must outlive the problem.
  AdjustmentProblem(const CalibrationViews& views,
                    const CalibrationOrigin& origin, CalibrationState* state)
      : views_(views),
        model_(ModelOf(views, origin)),
        state_(*state),
        y_(origin.NumbersOf(state->theta)),
        loss_(kLandmarkLossWidth),
        problem_(Ownership()) {
    for (const Rigid3d& pose : state_.world_from_cam) {
      poses_.push_back(PoseVectorOf(pose));
    }
    auto* const manifold = new PoseManifold();
    for (PoseVector& pose : poses_) AddPose(pose.data(), &problem_, manifold);
  }

  void AddLandmarks(bool training_only) {
    for (size_t i = 0; i < views_.landmarks.size(); ++i) {
      const Landmark& landmark = views_.landmarks[i];
      double* const anchor = poses_[landmark.anchor].data();
      double* const inverse_depth = &state_.inverse_depths[i];
      bool is_used = false;
      for (int k = 0; k < landmark.num_views; ++k) {
        const LandmarkView& view = views_.views[landmark.first_view + k];
        if (!view.TakesPart(training_only)) continue;
        if (!is_used) {
          Add(AnchorDepthFactor{model_, DataOf(views_, landmark, state_)},
              &loss_, inverse_depth, y_.data());
        }
        is_used = true;
        const LandmarkData data = DataOf(views_, landmark, view, state_);
        double* const there = poses_[view.keyframe].data();
        Add(LandmarkPixelFactor{model_, data}, &loss_, anchor, there,
            inverse_depth, y_.data());
        if (view.depth.inverse_sigma == 0.0) continue;
        Add(LandmarkDepthFactor{model_, data}, &loss_, anchor, there,
            inverse_depth, y_.data());
      }
    }
  }

  void AddDistances() {
    for (const KnownDistance& known : views_.distances) {
      Add(ScaledDistanceFactor{model_, known}, nullptr, poses_[known.a].data(),
          poses_[known.b].data(), y_.data());
    }
  }

  // y is in standard deviations of the prior, so the residual is y itself.
  void AddPrior() {
    problem_.AddResidualBlock(
        new ceres::NormalPrior(CalibrationMatrix::Identity(),
                               CalibrationVector::Zero()),
        nullptr, y_.data());
  }

  // Fixes the first pose, and theta unless any of it is free.
  void Fix(const FreeParts& is_free) {
    problem_.SetParameterBlockConstant(poses_[0].data());
    if (is_free.none()) problem_.SetParameterBlockConstant(y_.data());
  }

  // The order of elimination: first the depths, of which none depends on
  // another.
  ceres::ParameterBlockOrdering Elimination() {
    ceres::ParameterBlockOrdering ordering;
    for (double& depth : state_.inverse_depths) {
      if (problem_.HasParameterBlock(&depth)) {
        ordering.AddElementToGroup(&depth, 0);
      }
    }
    for (PoseVector& pose : poses_) ordering.AddElementToGroup(pose.data(), 1);
    ordering.AddElementToGroup(y_.data(), 1);
    return ordering;
  }

  ceres::Problem* problem() { return &problem_; }

  // Brings the solution into the state.
  void TakeSolution() {
    for (size_t i = 0; i < poses_.size(); ++i) {
      state_.world_from_cam[i] = RigidOf(poses_[i]);
    }
    state_.theta = model_->origin.At(y_);
  }

 private:
  static ceres::Problem::Options Ownership() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  template <typename Factor, typename... Blocks>
  void Add(Factor factor, ceres::LossFunction* loss, Blocks... blocks) {
    problem_.AddResidualBlock(MakeFactor(std::move(factor)), loss, blocks...);
  }

  const CalibrationViews& views_;
  const std::shared_ptr<const CalibrationModel> model_;
  CalibrationState& state_;
  std::vector<PoseVector> poses_;  // world_from_cam
  CalibrationVector y_;
  ceres::CauchyLoss loss_;
  ceres::Problem problem_;
};

}  // namespace

CalibrationState BundleAdjustment::Begin(const CalibrationVector& theta) const {
  CalibrationState state = {views_.world_from_cam, {}, theta};
  for (const Landmark& landmark : views_.landmarks) {
    state.inverse_depths.push_back(landmark.depth.value);
  }
  return state;
}

CalibrationOrigin BundleAdjustment::OriginOf(
    const FreeParts& is_free, const CalibrationVector& theta) const {
  CalibrationOrigin origin{theta, CalibrationVector::Zero()};
  for (int k = 0; k < kCalibrationSize; ++k) {
    if (!is_free[k]) continue;
    origin.start[k] = prior_.mean[k];
    origin.width[k] = prior_.sigma[k];
  }
  return origin;
}

void BundleAdjustment::MeasureScales(CalibrationState* state) const {
  state->pixel_scale = state->depth_scale = 1.0;
  const auto model = ModelOf(views_);
  const std::vector<PoseOf<double>> poses = PosesOf(*state);
  const CalibrationVector& theta = state->theta;
  std::vector<double> pixels, depths;
  double r[2];
  for (size_t i = 0; i < views_.landmarks.size(); ++i) {
    const Landmark& landmark = views_.landmarks[i];
    const Eigen::Matrix<double, 1, 1> d(state->inverse_depths[i]);
    const PoseOf<double>& anchor = poses[landmark.anchor];
    AnchorDepthFactor{model, DataOf(views_, landmark, *state)}.Residual(
        d, theta, r);
    depths.push_back(std::abs(r[0]));
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views_.views[landmark.first_view + k];
      if (!view.TakesPart(training_only_)) continue;
      const LandmarkData data = DataOf(views_, landmark, view, *state);
      const PoseOf<double>& there = poses[view.keyframe];
      LandmarkPixelFactor{model, data}.Residual(anchor, there, d, theta, r);
      pixels.push_back(std::abs(r[0]));
      pixels.push_back(std::abs(r[1]));
      if (data.depth.inverse_sigma == 0.0) continue;
      LandmarkDepthFactor{model, data}.Residual(anchor, there, d, theta, r);
      depths.push_back(std::abs(r[0]));
    }
  }
  constexpr double kLeast = 1e-3;
  const auto scale_of = [&](std::vector<double>* values) {
    if (values->empty()) return 1.0;
    return std::max(kLeast, kSigmaOfMedian * UpperMedian(values));
  };
  state->pixel_scale = scale_of(&pixels);
  state->depth_scale = scale_of(&depths);
}

double BundleAdjustment::Solve(const FreeParts& is_free,
                               CalibrationState* state) const {
  AdjustmentProblem adjustment(views_, OriginOf(is_free, state->theta), state);
  adjustment.AddLandmarks(training_only_);
  adjustment.AddDistances();
  adjustment.AddPrior();
  adjustment.Fix(is_free);

  ceres::Solver::Options options;
  options.linear_solver_ordering.reset(
      new ceres::ParameterBlockOrdering(adjustment.Elimination()));
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = max_iterations_;
  options.num_threads = 1;
  options.function_tolerance = 1e-5;
  options.initial_trust_region_radius = 1e6;
  options.logging_type = ceres::SILENT;
  IterationReport report(on_iteration_);
  options.callbacks.push_back(&report);
  ceres::Solver::Summary summary;
  ceres::Solve(options, adjustment.problem(), &summary);
  report.PassOn();
  if (!summary.IsSolutionUsable()) {
    return NAN;
  }
  adjustment.TakeSolution();
  return summary.final_cost;
}

std::optional<CalibrationVector> BundleAdjustment::Variances(
    const FreeParts& is_free, const CalibrationState& state) const {
  CalibrationMatrix model, sandwich;
  if (!LandmarkCovariance(views_, training_only_,
                          OriginOf(is_free, state.theta), state, &model,
                          &sandwich)) {
    return std::nullopt;
  }
  return CalibrationVector(model.diagonal().cwiseMax(sandwich.diagonal()));
}

}  // namespace rgbd_pose
