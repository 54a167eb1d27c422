#include "core/inertial/mean_force.h"

#include <algorithm>
#include <cmath>

#include "core/inertial/camera_imu.h"
#include "core/inertial/imu_buffer.h"

namespace rgbd_pose {
namespace {

// Sides may be shorter by this share, where a path begins or frames are rare.
constexpr double kShortest = 0.8;

constexpr double kRounding = 1e-6;  // of stamps, s

// The acceleration of a sample in between.
Eigen::Vector3d AccelAt(const ImuSample& a, const ImuSample& b, double stamp) {
  return a.accel +
         (stamp - a.stamp) / (b.stamp - a.stamp) * (b.accel - a.accel);
}

}  // namespace

void ForceMeter::Add(const std::vector<ImuSample>& samples) {
  for (const ImuSample& sample : samples) {
    if (!std::isfinite(sample.stamp) || !sample.accel.allFinite()) continue;
    if (!samples_.empty() && !(sample.stamp > samples_.back().stamp)) continue;
    samples_.push_back(sample);
  }
}

void ForceMeter::CorrectBy(const CameraImu* imu) {
  if (imu == nullptr) return;
  sensor_.calibration = imu->Correction().value_or(sensor_.calibration);
}

bool ForceMeter::AddUp(const Trajectory& path, size_t from, size_t to,
                       double first, double last, Eigen::Vector3d* sum) const {
  const Eigen::Quaterniond cam_from_imu =
      sensor_.calibration.cam_from_imu->rotation;
  const double delay = sensor_.calibration.delay_s.value_or(0.0);
  const double begin = path[from].timestamp + delay;
  const double end = path[to].timestamp + delay;
  auto next = std::upper_bound(
      samples_.begin(), samples_.end(), begin,
      [](double time, const ImuSample& sample) { return time < sample.stamp; });
  if (next == samples_.begin()) return false;
  size_t pose = from;  // the last one up to `stamp`
  const auto value = [&](double stamp, const Eigen::Vector3d& accel) {
    while (pose + 2 < path.size() &&
           path[pose + 1].timestamp + delay <= stamp) {
      ++pose;
    }
    // The last two poses may have one stamp.
    const double length = path[pose + 1].timestamp - path[pose].timestamp;
    const double part =
        length > 0.0 ? (stamp - delay - path[pose].timestamp) / length : 0.0;
    const Eigen::Quaterniond world_from_cam =
        path[pose].world_from_cam.rotation.slerp(
            part, path[pose + 1].world_from_cam.rotation);
    const double weight =
        first + (last - first) * (stamp - begin) / (end - begin);
    return Eigen::Vector3d(weight * (world_from_cam * (cam_from_imu * accel)));
  };
  double stamp = begin;
  Eigen::Vector3d before;
  for (bool is_first = true; stamp < end; is_first = false, ++next) {
    if (next == samples_.end() ||
        next->stamp - next[-1].stamp > ImuBuffer::kMaxGap) {
      return false;
    }
    if (is_first) before = value(begin, AccelAt(next[-1], *next, begin));
    const double until = std::min(next->stamp, end);
    const Eigen::Vector3d after = value(until, AccelAt(next[-1], *next, until));
    *sum += 0.5 * (until - stamp) * (before + after);
    before = after;
    stamp = until;
  }
  return true;
}

std::optional<MeanForce> ForceMeter::At(const Trajectory& path,
                                        size_t at) const {
  const std::optional<Rigid3d>& cam_from_imu = sensor_.calibration.cam_from_imu;
  if (!cam_from_imu.has_value()) return std::nullopt;
  const auto time = [&](size_t pose) { return path[pose].timestamp; };
  size_t from = at, to = at;
  while (from > 0 && time(at) - time(from) < kSide - kRounding &&
         time(from) - time(from - 1) <= kMaxGap) {
    --from;
  }
  while (to + 1 < path.size() && time(to) - time(at) < kSide - kRounding &&
         time(to + 1) - time(to) <= kMaxGap) {
    ++to;
  }
  const double before = time(at) - time(from), after = time(to) - time(at);
  if (std::min(before, after) < kShortest * kSide) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (!AddUp(path, from, at, 0.0, 1.0, &sum)) return std::nullopt;
  if (!AddUp(path, at, to, 1.0, 0.0, &sum)) return std::nullopt;
  const auto position = [&](size_t pose) {
    return path[pose].world_from_cam * cam_from_imu->translation;
  };
  const Eigen::Vector3d change = (position(to) - position(at)) / after -
                                 (position(at) - position(from)) / before;
  const Eigen::Vector3d up = 2.0 / (before + after) * (sum - change);
  const Rigid3d& pose = path[at].world_from_cam;
  return MeanForce{at, pose, pose.rotation.conjugate() * up};
}

std::vector<MeanForce> ForceMeter::Along(const Trajectory& path) const {
  std::vector<MeanForce> forces;
  double next = 0.0;
  for (size_t at = 0; at < path.size(); ++at) {
    if (!forces.empty() && path[at].timestamp < next) continue;
    const std::optional<MeanForce> force = At(path, at);
    if (!force.has_value()) continue;
    forces.push_back(*force);
    next = path[at].timestamp + kSide;
  }
  return forces;
}

}  // namespace rgbd_pose
