#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "apps/calibration/calibration_data.h"
#include "core/evaluation/association.h"
#include "core/util/input_error.h"
#include "frontend/tracking/motion_guess.h"

namespace rgbd_pose {
namespace {

// Standard deviations of a length measured by hand, a ground-truth distance and
// a motion guess, for example from wheels (plus a share of the distance).
constexpr double kLengthSigma = 0.005;  // m
constexpr double kTruthSigma = 0.005;   // m
constexpr double kGuessSigma = 0.01;    // m
constexpr double kGuessShare = 0.02;

// Keyframes at this distance (m) determine the scale well; nearer ones less so.
constexpr double kFarApart = 0.5;

// The position of a frame relative to the nearest keyframe in time.
struct Place {
  int keyframe = 0;
  Eigen::Vector3d in_keyframe;
};

Place PlaceAt(const CalibrationData& data, const Trajectory& path,
              double time) {
  const auto frame_at = [&path](double t) {
    return std::min_element(path.begin(), path.end(),
                            [t](const StampedPose& a, const StampedPose& b) {
                              return std::abs(a.timestamp - t) <
                                     std::abs(b.timestamp - t);
                            });
  };
  const auto frame = frame_at(time);
  constexpr double kMaxOff = 0.1;  // s
  if (frame == path.end() || std::abs(frame->timestamp - time) > kMaxOff) {
    throw InputError("known_length: no frame was tracked at " +
                     std::to_string(time) + " s");
  }
  const size_t keyframe = NearestTime(data.timestamps, time);
  const auto at_keyframe = frame_at(data.timestamps[keyframe]);
  return {static_cast<int>(keyframe),
          (at_keyframe->world_from_cam.Inverse() * frame->world_from_cam)
              .translation};
}

KnownDistance FromText(const CalibrationData& data, const Trajectory& path,
                       const std::string& text) {
  double t0, t1, metres;
  char end;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &t0, &t1, &metres, &end) !=
          3 ||
      !std::isfinite(t0) || !std::isfinite(t1) || !(metres > 0.0) ||
      !std::isfinite(metres)) {
    throw InputError("known_length: must be T0,T1,METRES, not '" + text + "'");
  }
  const Place a = PlaceAt(data, path, t0), b = PlaceAt(data, path, t1);
  if (a.keyframe == b.keyframe) {
    throw InputError(
        "known_length: the camera hardly moved between the two times");
  }
  return {a.keyframe,    b.keyframe, a.in_keyframe,
          b.in_keyframe, metres,     kLengthSigma};
}

// Connects each keyframe to the first distant one, or to the farthest one.
// `distance(from, to)` returns the distance (m) of the camera positions at two
// times (s), or nothing if it is unknown.
template <typename Distance>
std::vector<KnownDistance> Between(const CalibrationData& data,
                                   const Distance& distance, double sigma,
                                   double share) {
  std::vector<KnownDistance> distances;
  const int n = static_cast<int>(data.timestamps.size());
  for (int i = 0; i < n; ++i) {
    KnownDistance farthest;
    for (int k = i + 1; k < n && farthest.metres < kFarApart; ++k) {
      const std::optional<double> metres =
          distance(data.timestamps[i], data.timestamps[k]);
      if (!metres.has_value() || *metres <= farthest.metres) continue;
      farthest.a = i;
      farthest.b = k;
      farthest.metres = *metres;
      farthest.sigma = std::hypot(sigma, share * *metres);
    }
    constexpr double kMinDistance = 0.05;  // m
    if (farthest.metres > kMinDistance) distances.push_back(farthest);
  }
  return distances;
}

std::optional<Eigen::Vector3d> PlaceOf(const Trajectory& truth, double time) {
  const auto after = std::lower_bound(
      truth.begin(), truth.end(), time,
      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  constexpr double kMaxGap = 0.1;  // s
  if (after == truth.end()) return std::nullopt;
  if (after == truth.begin()) {
    return after->timestamp == time
               ? std::make_optional(after->world_from_cam.translation)
               : std::nullopt;
  }
  const auto before = after - 1;
  const double gap = after->timestamp - before->timestamp;
  if (gap > kMaxGap) return std::nullopt;
  const double share = (time - before->timestamp) / gap;
  return (1.0 - share) * before->world_from_cam.translation +
         share * after->world_from_cam.translation;
}

}  // namespace

std::string AddKnownDistances(const Trajectory& path,
                              const std::string& known_length,
                              const CalibrationScale& scale,
                              CalibrationData* data) {
  std::vector<KnownDistance>& distances = data->views.distances;
  if (!known_length.empty()) {
    distances.push_back(FromText(*data, path, known_length));
    return "the known length";
  }
  if (scale.ground_truth != nullptr) {
    distances = Between(
        *data,
        [&](double from, double to) -> std::optional<double> {
          const auto a = PlaceOf(*scale.ground_truth, from);
          const auto b = PlaceOf(*scale.ground_truth, to);
          if (!a.has_value() || !b.has_value()) return std::nullopt;
          return (*a - *b).norm();
        },
        kTruthSigma, 0.0);
    if (!distances.empty()) return "the ground truth";
  }
  if (scale.motion_guess != nullptr) {
    distances = Between(
        *data,
        [&](double from, double to) -> std::optional<double> {
          const auto moved = MotionAlong(*scale.motion_guess, from, to);
          if (!moved.has_value()) return std::nullopt;
          return moved->translation.norm();
        },
        kGuessSigma, kGuessShare);
    if (!distances.empty()) return "the motion guess";
  }
  return "";
}

}  // namespace rgbd_pose
