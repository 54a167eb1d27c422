#include "frontend/calibration/calibration_halves.h"

#include <cmath>

#include "frontend/calibration/calibration_result.h"

namespace rgbd_pose {
namespace {

// The part of a recording that has these consecutive keyframes, in the state of
// the whole recording.
CalibrationHalf PartOf(const CalibrationViews& all,
                       const CalibrationState& found, int begin, int end) {
  CalibrationHalf part;
  CalibrationViews& views = part.views;
  views.camera = all.camera;
  views.world_from_cam.assign(found.world_from_cam.begin() + begin,
                              found.world_from_cam.begin() + end);
  views.twists.assign(all.twists.begin() + begin, all.twists.begin() + end);
  part.state.theta = found.theta;
  part.state.pixel_scale = found.pixel_scale;
  part.state.depth_scale = found.depth_scale;
  part.state.world_from_cam = views.world_from_cam;
  const auto is_in = [&](int keyframe) {
    return keyframe >= begin && keyframe < end;
  };
  for (size_t i = 0; i < all.landmarks.size(); ++i) {
    Landmark landmark = all.landmarks[i];
    if (!is_in(landmark.anchor)) continue;
    landmark.anchor -= begin;
    landmark.first_view = static_cast<int>(views.views.size());
    landmark.num_views = 0;
    for (int k = 0; k < all.landmarks[i].num_views; ++k) {
      LandmarkView view = all.views[all.landmarks[i].first_view + k];
      if (!is_in(view.keyframe)) continue;
      view.keyframe -= begin;
      views.views.push_back(view);
      ++landmark.num_views;
    }
    if (landmark.num_views == 0) continue;
    views.landmarks.push_back(landmark);
    part.state.inverse_depths.push_back(found.inverse_depths[i]);
  }
  for (KnownDistance known : all.distances) {
    if (!is_in(known.a) || !is_in(known.b)) continue;
    known.a -= begin;
    known.b -= begin;
    views.distances.push_back(known);
  }
  return part;
}

}  // namespace

std::array<CalibrationHalf, 2> HalvesOf(const CalibrationViews& views,
                                        const CalibrationState& solved) {
  const int all = static_cast<int>(views.world_from_cam.size());
  return {PartOf(views, solved, 0, all / 2),
          PartOf(views, solved, all / 2, all)};
}

double SpreadOfHalves(const std::vector<HalvesOfParameter>& halves) {
  if (halves.empty()) return 0.0;
  double squares = 0.0;
  for (const HalvesOfParameter& half : halves) {
    squares += half.Sigmas() * half.Sigmas();
  }
  return std::sqrt(squares / halves.size());
}

std::vector<HalvesOfParameter> SplitHalfConsistency(
    const CalibrationViews& views, const CalibrationState& found,
    const FreeParts& is_free, const CalibrationPrior& prior,
    const std::function<void()>& on_iteration) {
  // Smaller parts cannot be calibrated.
  constexpr size_t kMinKeyframes = 3;
  constexpr size_t kMinViews = 200;
  std::array<CalibrationHalf, 2> halves = HalvesOf(views, found);
  CalibrationVector variance[2];
  // The halves are solved one after the other: in parallel, the order of
  // additions would change.
  for (int k = 0; k < 2; ++k) {
    CalibrationHalf& half = halves[k];
    if (half.views.world_from_cam.size() < kMinKeyframes ||
        half.views.views.size() < kMinViews) {
      return {};
    }
    const BundleAdjustment problem(half.views, prior, false,
                                   BundleAdjustment::kMaxIterations,
                                   on_iteration);
    if (!std::isfinite(problem.Solve(is_free, &half.state))) return {};
    problem.MeasureScales(&half.state);
    const auto variances = problem.Variances(is_free, half.state);
    if (!variances.has_value()) return {};
    variance[k] = *variances;
  }
  std::vector<HalvesOfParameter> result;
  for (int k = 0; k < kCalibrationSize; ++k) {
    if (!is_free[k]) continue;
    const double floor =
        CalibrationFloor(k, static_cast<int>(views.world_from_cam.size() / 2));
    result.push_back(
        {k, halves[0].state.theta[k], halves[1].state.theta[k],
         std::sqrt(variance[0][k] + variance[1][k] + 2.0 * floor * floor)});
  }
  return result;
}

}  // namespace rgbd_pose
