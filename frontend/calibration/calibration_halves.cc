#include <cmath>

#include "frontend/calibration/calibration_result.h"

namespace rgbd_pose {
namespace {

// The views of consecutive keyframes and their solution.
struct Part {
  CalibrationViews views;
  CalibrationState state;
  CalibrationVector variance;  // of theta
};

// The state is that of the whole recording.
Part PartOf(const CalibrationViews& all, const CalibrationState& found,
            int begin, int end) {
  Part part;
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
  const int all = static_cast<int>(views.world_from_cam.size());
  // Smaller parts cannot be calibrated.
  constexpr int kMinKeyframes = 3;
  constexpr size_t kMinViews = 200;
  Part halves[2];
  // One half after the other: in parallel, the order of additions would change.
  for (int half = 0; half < 2; ++half) {
    const int begin = half * (all / 2), end = half == 0 ? all / 2 : all;
    if (end - begin < kMinKeyframes) return {};
    Part& part = halves[half];
    part = PartOf(views, found, begin, end);
    if (part.views.views.size() < kMinViews) return {};
    const BundleAdjustment problem(part.views, prior, false,
                                   BundleAdjustment::kMaxIterations,
                                   on_iteration);
    if (!std::isfinite(problem.Solve(is_free, &part.state))) return {};
    problem.MeasureScales(&part.state);
    const auto variances = problem.Variances(is_free, part.state);
    if (!variances.has_value()) return {};
    part.variance = *variances;
  }
  std::vector<HalvesOfParameter> result;
  for (int k = 0; k < kCalibrationSize; ++k) {
    if (!is_free[k]) continue;
    const double floor = CalibrationFloor(k, all / 2);
    result.push_back({k, halves[0].state.theta[k], halves[1].state.theta[k],
                      std::sqrt(halves[0].variance[k] + halves[1].variance[k] +
                                2.0 * floor * floor)});
  }
  return result;
}

}  // namespace rgbd_pose
