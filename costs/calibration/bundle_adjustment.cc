#include "costs/calibration/bundle_adjustment.h"

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/util/quantile.h"
#include "costs/calibration/landmark_block.h"

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

// The problem that Ceres solves: depths are those of the state, all other
// unknowns are relative to it.
class AdjustmentProblem {
 public:
  // `views` and `state` must outlive the problem. `y`: see CalibrationOrigin.
  AdjustmentProblem(const CalibrationViews& views,
                    const CalibrationOrigin& origin, const CalibrationVector& y,
                    CalibrationState* state)
      : views_(views),
        origin_(origin),
        state_(*state),
        x_(state->world_from_cam.size(), MotionVector::Zero()),
        y_(y),
        loss_(kLandmarkLossWidth),
        problem_(Ownership()) {
    for (const Rigid3d& pose : state_.world_from_cam) {
      origins_.emplace_back(pose.Inverse());
    }
    data_.reserve(views_.landmarks.size() + views_.views.size());
  }

  void AddLandmarks(bool training_only) {
    for (size_t i = 0; i < views_.landmarks.size(); ++i) {
      const Landmark& landmark = views_.landmarks[i];
      // Adds a residual of the measurements appended last.
      const auto add = [&](auto residual, int keyframe) {
        problem_.AddResidualBlock(
            new LandmarkBlock<decltype(residual)>(origins_[landmark.anchor],
                                                  origins_[keyframe], origin_,
                                                  data_.back()),
            &loss_, x_[landmark.anchor].data(), x_[keyframe].data(),
            &state_.inverse_depths[i], y_.data());
      };
      data_.push_back(DataOf(views_, landmark, state_));
      bool is_used = false;
      for (int k = 0; k < landmark.num_views; ++k) {
        const LandmarkView& view = views_.views[landmark.first_view + k];
        if (!view.TakesPart(training_only)) continue;
        // The view's pose is a dummy: an anchor's depth does not depend on it.
        if (!is_used) add(AnchorDepth(), view.keyframe);
        is_used = true;
        data_.push_back(DataOf(views_, landmark, view, state_));
        add(LandmarkPixel(), view.keyframe);
        if (view.depth.inverse_sigma != 0.0) {
          add(LandmarkDepth(), view.keyframe);
        }
      }
    }
  }

  void AddDistances() {
    for (const KnownDistance& known : views_.distances) {
      problem_.AddResidualBlock(
          new KnownDistanceBlock(origins_[known.a], origins_[known.b], origin_,
                                 known),
          nullptr, x_[known.a].data(), x_[known.b].data(), y_.data());
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
    if (problem_.HasParameterBlock(x_[0].data())) {
      problem_.SetParameterBlockConstant(x_[0].data());
    }
    if (is_free.none()) problem_.SetParameterBlockConstant(y_.data());
  }

  // The order of elimination: first the depths, of which none depends on
  // another.
  ceres::ParameterBlockOrdering Elimination() {
    ceres::ParameterBlockOrdering ordering;
    const auto add = [&](double* block, int group) {
      if (!problem_.HasParameterBlock(block)) return;
      ordering.AddElementToGroup(block, group);
    };
    for (double& depth : state_.inverse_depths) add(&depth, 0);
    for (MotionVector& pose : x_) add(pose.data(), 1);
    add(y_.data(), 1);
    return ordering;
  }

  ceres::Problem* problem() { return &problem_; }

  // Brings the solution into the state.
  void TakeSolution() {
    for (size_t i = 0; i < x_.size(); ++i) {
      state_.world_from_cam[i] =
          origins_[i].CurFromPrev(x_[i].data()).Inverse();
    }
    state_.theta = origin_.At(y_.data());
  }

 private:
  static ceres::Problem::Options Ownership() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  const CalibrationViews& views_;
  const CalibrationOrigin origin_;
  CalibrationState& state_;
  std::vector<LinearizationPoint> origins_;  // of the poses
  std::vector<MotionVector> x_;              // the poses, relative to these
  CalibrationVector y_;
  std::vector<LandmarkData> data_;  // reserved: must not move
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
  const std::vector<MotionDerivatives> poses = PosesOf(*state);
  state->pixel_scale = state->depth_scale = 1.0;
  std::vector<double> pixels, depths;
  double r[2];
  for (size_t i = 0; i < views_.landmarks.size(); ++i) {
    const Landmark& landmark = views_.landmarks[i];
    const double d = state->inverse_depths[i];
    const RotationAndCenter<double>& anchor = poses[landmark.anchor];
    AnchorDepth::Residual<double>(anchor, anchor, d, state->theta.data(),
                                  DataOf(views_, landmark, *state), r);
    depths.push_back(std::abs(r[0]));
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views_.views[landmark.first_view + k];
      if (!view.TakesPart(training_only_)) continue;
      const LandmarkData data = DataOf(views_, landmark, view, *state);
      const RotationAndCenter<double>& there = poses[view.keyframe];
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
  CalibrationVector y;
  for (int k = 0; k < kCalibrationSize; ++k) {
    y[k] =
        is_free[k] ? (state->theta[k] - prior_.mean[k]) / prior_.sigma[k] : 0.0;
  }
  AdjustmentProblem adjustment(views_, OriginOf(is_free, state->theta), y,
                               state);
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
