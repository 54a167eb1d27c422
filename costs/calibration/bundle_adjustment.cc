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
  const CalibrationOrigin origin = OriginOf(is_free, state->theta);
  std::vector<LinearizationPoint> origins;
  for (const Rigid3d& pose : state->world_from_cam) {
    origins.emplace_back(pose.Inverse());
  }
  std::vector<MotionVector> x(origins.size(), MotionVector::Zero());
  CalibrationVector y;
  for (int k = 0; k < kCalibrationSize; ++k) {
    y[k] =
        is_free[k] ? (state->theta[k] - prior_.mean[k]) / prior_.sigma[k] : 0.0;
  }
  const size_t num_landmarks = views_.landmarks.size();
  std::vector<LandmarkData> data;  // reserved: must not move
  data.reserve(num_landmarks + views_.views.size());

  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss loss(kLandmarkLossWidth);
  ceres::Problem problem(ownership);
  ceres::Solver::Options options;
  options.linear_solver_ordering.reset(new ceres::ParameterBlockOrdering);
  for (size_t i = 0; i < num_landmarks; ++i) {
    const Landmark& landmark = views_.landmarks[i];
    double* const d = &state->inverse_depths[i];
    // Adds a residual of the measurements appended last.
    const auto add = [&](auto residual, int keyframe) {
      problem.AddResidualBlock(
          new LandmarkBlock<decltype(residual)>(
              origins[landmark.anchor], origins[keyframe], origin, data.back()),
          &loss, x[landmark.anchor].data(), x[keyframe].data(), d, y.data());
    };
    data.push_back(DataOf(views_, landmark, *state));
    int used = 0;
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views_.views[landmark.first_view + k];
      if (!view.TakesPart(training_only_)) continue;
      // The view's pose is a dummy: an anchor's depth does not depend on it.
      if (used++ == 0) add(AnchorDepth(), view.keyframe);
      data.push_back(DataOf(views_, landmark, view, *state));
      add(LandmarkPixel(), view.keyframe);
      if (view.depth.inverse_sigma != 0.0) add(LandmarkDepth(), view.keyframe);
    }
    if (used > 0) options.linear_solver_ordering->AddElementToGroup(d, 0);
  }
  for (const KnownDistance& known : views_.distances) {
    problem.AddResidualBlock(
        new KnownDistanceBlock(origins[known.a], origins[known.b], origin,
                               known),
        nullptr, x[known.a].data(), x[known.b].data(), y.data());
  }
  // y is in standard deviations of the prior, so the residual is y itself.
  problem.AddResidualBlock(new ceres::NormalPrior(CalibrationMatrix::Identity(),
                                                  CalibrationVector::Zero()),
                           nullptr, y.data());
  options.linear_solver_ordering->AddElementToGroup(y.data(), 1);
  for (MotionVector& pose : x) {
    if (!problem.HasParameterBlock(pose.data())) continue;
    options.linear_solver_ordering->AddElementToGroup(pose.data(), 1);
  }
  if (problem.HasParameterBlock(x[0].data())) {
    problem.SetParameterBlockConstant(x[0].data());
  }
  if (is_free.none()) problem.SetParameterBlockConstant(y.data());

  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = max_iterations_;
  options.num_threads = 1;
  options.function_tolerance = 1e-5;
  options.initial_trust_region_radius = 1e6;
  options.logging_type = ceres::SILENT;
  IterationReport report(on_iteration_);
  options.callbacks.push_back(&report);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  report.PassOn();
  if (!summary.IsSolutionUsable()) {
    return NAN;
  }
  for (size_t i = 0; i < x.size(); ++i) {
    state->world_from_cam[i] = origins[i].CurFromPrev(x[i].data()).Inverse();
  }
  state->theta = origin.At(y.data());
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
