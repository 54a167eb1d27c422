#include "apps/results/motion_jumps.h"

#include <algorithm>

#include "core/util/format.h"
#include "core/util/quantile.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

constexpr double kLeastMetres = 0.01;
constexpr double kTimesMedian = 6.0;
constexpr size_t kMostJumps = 20;

// Motions over unequal times cannot be compared.
constexpr double kMaxIntervalRatio = 1.6;

// How far the motion to frame i is from the mean of its neighbours'; negative
// where it cannot be said.
double Deviation(const std::vector<TrackedFrame>& frames, size_t i) {
  double shortest = 1e9, longest = 0.0;
  for (size_t k = i - 2; k <= i + 1; ++k) {
    if (frames[k].status == TrackingStatus::kLost ||
        frames[k].segment != frames[i].segment) {
      return -1.0;
    }
    if (k == i + 1) break;
    const double interval = frames[k + 1].timestamp - frames[k].timestamp;
    shortest = std::min(shortest, interval);
    longest = std::max(longest, interval);
  }
  if (longest > kMaxIntervalRatio * shortest) return -1.0;
  const auto place = [&](size_t k) -> const Eigen::Vector3d& {
    return frames[k].world_from_cam.translation;
  };
  const Eigen::Vector3d neighbours =
      place(i + 1) - place(i) + place(i - 1) - place(i - 2);
  return (place(i) - place(i - 1) - 0.5 * neighbours).norm();
}

}  // namespace

std::vector<MotionJump> FindJumps(const std::vector<TrackedFrame>& frames) {
  std::vector<double> deviations;
  std::vector<MotionJump> jumps;
  for (size_t i = 2; i + 1 < frames.size(); ++i) {
    const double deviation = Deviation(frames, i);
    if (deviation < 0.0) continue;
    deviations.push_back(deviation);
    // One motion that is off makes its neighbours differ, too.
    if (!jumps.empty() && jumps.back().frame + 2 >= static_cast<int>(i)) {
      if (jumps.back().translation >= 0.99 * deviation) continue;
      jumps.pop_back();
    }
    jumps.push_back({static_cast<int>(i), deviation});
  }
  if (deviations.empty()) return {};
  const double limit =
      std::max(kLeastMetres, kTimesMedian * Median(deviations));
  jumps.erase(std::remove_if(jumps.begin(), jumps.end(),
                             [=](const MotionJump& jump) {
                               return jump.translation <= limit;
                             }),
              jumps.end());
  std::stable_sort(jumps.begin(), jumps.end(),
                   [](const MotionJump& a, const MotionJump& b) {
                     return a.translation > b.translation;
                   });
  jumps.resize(std::min(jumps.size(), kMostJumps));
  return jumps;
}

std::string FormatJumps(const std::vector<MotionJump>& jumps,
                        const std::vector<TrackedFrame>& frames) {
  if (jumps.empty()) return "";
  const TrackedFrame& frame = frames[jumps[0].frame];
  return Format(
      "jumps       %zu%s, the largest at frame %d by %.0f mm (%d of %d %s "
      "agree); --debug_images=%d shows it\n",
      jumps.size(), jumps.size() == kMostJumps ? " or more" : "",
      jumps[0].frame, kMillimetresPerMetre * jumps[0].translation,
      frame.inliers, frame.matches,
      frame.source == TrackingSource::kDirect ? "pixels" : "matches",
      jumps[0].frame);
}

nlohmann::json JumpsToJson(const std::vector<MotionJump>& jumps,
                           const std::vector<TrackedFrame>& frames) {
  nlohmann::json list = nlohmann::json::array();
  for (const MotionJump& jump : jumps) {
    const TrackedFrame& frame = frames[jump.frame];
    list.push_back({{"frame", jump.frame},
                    {"seconds", frame.timestamp - frames[0].timestamp},
                    {"translation_m", jump.translation},
                    {"status", ToString(frame.status)},
                    {"tracking_source", ToString(frame.source)},
                    {"matches", frame.matches},
                    {"inliers", frame.inliers},
                    {"sigma", frame.sigma}});
  }
  return list;
}

}  // namespace rgbd_pose
