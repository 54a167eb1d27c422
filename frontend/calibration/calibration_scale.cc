#include <algorithm>
#include <cmath>
#include <vector>

#include "core/evaluation/association.h"
#include "core/evaluation/trajectory.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/calibration/calibration_data.h"

namespace rgbd_pose {
namespace {

KnownDistance FromText(const CalibrationData& data, const Trajectory& path,
                       const std::string& text) {
  std::vector<double> numbers;
  try {
    for (const std::string& word : SplitList(text)) {
      numbers.push_back(ParseNumber(word, "", 0, ""));
    }
  } catch (const InputError&) {
    numbers.clear();
  }
  if (numbers.size() != 3 || !(numbers[2] > 0.0)) {
    throw InputError("known_length: must be T0,T1,METRES, not '" + text + "'");
  }
  KnownDistance known;
  known.metres = numbers[2];
  const std::vector<double> times = TimesOf(path);
  // The position of a frame relative to the nearest keyframe in time.
  const auto find = [&](double time, int* keyframe,
                        Eigen::Vector3d* in_keyframe) {
    const size_t frame = NearestTime(times, time);
    constexpr double kMaxOff = 0.1;  // s
    if (times.empty() || data.timestamps.empty() ||
        std::abs(times[frame] - time) > kMaxOff) {
      throw InputError("known_length: no frame was tracked at " +
                       std::to_string(time) + " s");
    }
    *keyframe = static_cast<int>(NearestTime(data.timestamps, time));
    const size_t at = NearestTime(times, data.timestamps[*keyframe]);
    // The path does not know the motion across lost frames.
    const auto [first, last] = std::minmax(frame, at);
    const double usual = (times.back() - times.front()) / (times.size() - 1);
    for (size_t i = first; i < last; ++i) {
      if (times[i + 1] - times[i] < 1.5 * usual) continue;
      throw InputError("known_length: frames near " + ShortNumber(time) +
                       " s were lost; choose another time");
    }
    *in_keyframe =
        (path[at].world_from_cam.Inverse() * path[frame].world_from_cam)
            .translation;
  };
  find(numbers[0], &known.a, &known.in_a);
  find(numbers[1], &known.b, &known.in_b);
  if (known.a == known.b) {
    throw InputError(
        "known_length: the camera hardly moved between the two times");
  }
  known.sigma = 0.005;  // m, of a length measured by hand
  return known;
}

// Connects each keyframe to the first distant one, or to the farthest one.
// `distance(from, to)` returns the distance (m) of the camera positions at two
// times (s), 0 if it is unknown. Its standard deviation is `sigma` (m) and a
// `share` of it. Returns whether any distances are known.
template <typename Distance>
bool Connect(const Distance& distance, double sigma, double share,
             CalibrationData* data) {
  // Keyframes at this distance determine the scale well, nearer ones less so.
  constexpr double kFarApart = 0.5;      // m
  constexpr double kMinDistance = 0.05;  // m
  const int n = static_cast<int>(data->timestamps.size());
  for (int i = 0; i < n; ++i) {
    KnownDistance farthest;
    farthest.metres = 0.0;
    for (int k = i + 1; k < n && farthest.metres < kFarApart; ++k) {
      const double metres = distance(data->timestamps[i], data->timestamps[k]);
      if (metres <= farthest.metres) continue;
      farthest.a = i;
      farthest.b = k;
      farthest.metres = metres;
      farthest.sigma = std::hypot(sigma, share * metres);
    }
    if (farthest.metres > kMinDistance) {
      data->views.distances.push_back(farthest);
    }
  }
  return !data->views.distances.empty();
}

}  // namespace

std::string AddKnownDistances(const Trajectory& path,
                              const std::string& known_length,
                              const CalibrationScale& scale,
                              CalibrationData* data) {
  if (!known_length.empty()) {
    data->views.distances.push_back(FromText(*data, path, known_length));
    return "the known length";
  }
  const auto true_distance = [&](double from, double to) {
    constexpr double kMaxGap = 0.1 + 1e-6;  // s; stamps are rounded
    const auto a = InterpolatedPose(*scale.ground_truth, from, kMaxGap);
    const auto b = InterpolatedPose(*scale.ground_truth, to, kMaxGap);
    if (!a.has_value() || !b.has_value()) return 0.0;
    return (a->translation - b->translation).norm();
  };
  if (scale.ground_truth != nullptr &&
      Connect(true_distance, /*sigma=*/0.005, /*share=*/0.0, data)) {
    return "the ground truth";
  }
  const auto guessed_distance = [&](double from, double to) {
    const auto moved = MotionAlong(*scale.motion_guess, from, to);
    return moved.has_value() ? moved->translation.norm() : 0.0;
  };
  if (scale.motion_guess != nullptr &&
      Connect(guessed_distance, /*sigma=*/0.01, /*share=*/0.02, data)) {
    return "the motion guess";
  }
  return "";
}

}  // namespace rgbd_pose
