#include "frontend/calibration/calibration_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/geometry/twist.h"
#include "core/util/parallel_for.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {
namespace {

// A landmark and its views in other keyframes.
struct SeenLandmark {
  Landmark landmark;
  std::vector<LandmarkView> views;
};

// Matches features of keyframes in other keyframes. Each thread has its own.
class LandmarkMatcher {
 public:
  // `map` and `chosen` must outlive the matcher. `chosen` has the map indices
  // of the keyframes; other functions use positions in `chosen`.
  LandmarkMatcher(const KeyframeMap& map, const std::vector<int>& chosen,
                  const FrontendOptions& options)
      : map_(map), chosen_(chosen), frontend_(MakeFrontend("patch", options)) {}

  // Landmarks with views in its neighbours (keyframe, whether it is held out).
  std::vector<SeenLandmark> Match(
      int anchor, const std::vector<std::pair<int, bool>>& neighbours) {
    const PreparedFrame frame = Images(anchor);
    const auto features = frontend_->Detect(frame);
    std::vector<SeenLandmark> found(features->observations.size());
    for (size_t i = 0; i < found.size(); ++i) {
      found[i].landmark.anchor = anchor;
      Measure(frame, features->observations[i], &found[i].landmark);
    }
    for (const auto& [to, is_held_out] : neighbours) {
      const PreparedFrame& there = Images(to);
      frontend_->Match(*features, there,
                       KeyframeAt(to).world_from_cam.Inverse() *
                           KeyframeAt(anchor).world_from_cam,
                       &matches_);
      for (size_t i = 0; i < matches_.matches.size(); ++i) {
        SeenLandmark& seen = found[matches_.features[i]];
        if (seen.landmark.depth.inverse_sigma == 0.0) continue;
        const Observation& o = matches_.matches[i].cur;
        LandmarkView view;
        Measure(there, o, &view);
        view.keyframe = to;
        view.sigma_px = o.sigma_px;
        view.is_held_out = is_held_out;
        seen.views.push_back(view);
      }
    }
    std::vector<SeenLandmark> seen;
    for (SeenLandmark& landmark : found) {
      if (!landmark.views.empty()) seen.push_back(std::move(landmark));
    }
    return seen;
  }

 private:
  const Keyframe& KeyframeAt(int at) const {
    return map_.keyframes[chosen_[at]];
  }

  void Measure(const Frame& frame, const Observation& o,
               DepthPixel* seen) const {
    const Camera& camera = map_.camera;
    const Eigen::Vector2d pixel = camera.Project(camera.Ray(o.u, o.v));
    seen->u = pixel.x();
    seen->v = pixel.y();
    seen->depth =
        MeasuredAt(frame, camera, o, pixel, frontend_->options().depth.noise);
  }

  // Decodes images once for consecutive neighbours.
  const PreparedFrame& Images(int at) {
    constexpr size_t kMost = 40;
    const auto [place, is_new] = images_.try_emplace(at);
    if (is_new) place->second = PreparedFrame(KeyframeAt(at).images.Restore());
    if (images_.size() > kMost) {
      // The keyframe farthest in time is needed last.
      images_.erase(std::max_element(
          images_.begin(), images_.end(), [at](const auto& a, const auto& b) {
            return std::abs(a.first - at) < std::abs(b.first - at);
          }));
    }
    return place->second;
  }

  const KeyframeMap& map_;
  const std::vector<int>& chosen_;
  std::unique_ptr<Frontend> frontend_;
  std::map<int, PreparedFrame> images_;
  FeatureMatches matches_;
};

// The velocity (zero if unknown) on a smooth path at the time of one of its
// frames (s): fourth-order central differences where frames are evenly spaced,
// else differences of adjacent frames.
Twist TwistAt(const Trajectory& path, double time) {
  const auto at = std::lower_bound(
      path.begin(), path.end(), time - 1e-4,
      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  if (at == path.end()) return {};
  using Place = Trajectory::const_iterator;
  // The next frame in a direction (1 or -1), or the same one before a gap.
  const auto next = [&](Place from, int direction) {
    constexpr double kMaxGap = 0.15;  // s
    if (from == (direction > 0 ? path.end() - 1 : path.begin())) return from;
    const Place to = from + direction;
    const bool is_near = std::abs(to->timestamp - from->timestamp) <= kMaxGap;
    return is_near ? to : from;
  };
  const Place before = next(at, -1), after = next(at, 1);
  if (before == after) return {};
  const Place first = next(before, -1), last = next(after, 1);
  const double near = after->timestamp - before->timestamp;
  const double far = last->timestamp - first->timestamp;
  const auto difference = [&](Place from, Place to, double interval) {
    // A pose of the path, expressed in the camera frame of the given time.
    const auto seen = [&](Place there) {
      return TwistOf(there->world_from_cam.Inverse() * at->world_from_cam,
                     interval);
    };
    return seen(to) - seen(from);
  };
  // The offset of the middle from the frame, s.
  const auto lean = [&](Place from, Place to) {
    return std::abs(0.5 * (from->timestamp + to->timestamp) - at->timestamp);
  };
  constexpr double kEven = 0.05;
  const bool is_even =
      std::abs(far / near - 2.0) < kEven &&
      std::max(lean(before, after), lean(first, last)) < kEven * near;
  Twist twist = difference(before, after, near);
  if (!is_even) return twist;
  return twist + (1.0 / 3.0) * (twist - difference(first, last, far));
}

// The keyframes of the largest segment, as indices in the map.
std::vector<int> ChosenKeyframes(const KeyframeMap& map) {
  using TimeAndIndex = std::pair<double, int>;
  std::map<int, std::vector<TimeAndIndex>> segments;
  for (size_t i = 0; i < map.keyframes.size(); ++i) {
    segments[map.keyframes[i].segment].emplace_back(
        map.keyframes[i].images.timestamp, i);
  }
  std::vector<TimeAndIndex> largest;
  for (const auto& [segment, members] : segments) {
    if (members.size() > largest.size()) largest = members;
  }
  std::sort(largest.begin(), largest.end());
  // The work grows with the third power of the number of keyframes.
  constexpr size_t kMaxKeyframes = 300;
  const size_t count = std::min(largest.size(), kMaxKeyframes);
  std::vector<int> chosen;
  for (size_t i = 0; i < count; ++i) {
    chosen.push_back(largest[i * largest.size() / count].second);
  }
  return chosen;
}

// Holds out one pair in five, but none that is needed to connect keyframes.
std::vector<bool> HeldOut(int num_keyframes,
                          const std::vector<std::array<int, 2>>& pairs) {
  std::vector<int> root(num_keyframes);
  for (int i = 0; i < num_keyframes; ++i) root[i] = i;
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::vector<bool> held_out(pairs.size(), false);
  std::vector<size_t> spare;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const int a = find(pairs[i][0]), b = find(pairs[i][1]);
    if (a == b) spare.push_back(i);
    root[a] = b;
  }
  // One in five of all pairs, if there are enough spare ones.
  constexpr int kHoldOut = 5;
  const double step = std::max(
      1.0, static_cast<double>(spare.size()) * kHoldOut / pairs.size());
  for (double i = 0.0; i < spare.size(); i += step) {
    held_out[spare[static_cast<size_t>(i)]] = true;
  }
  return held_out;
}

// The landmarks of each keyframe, from up to `max_features` features.
std::vector<std::vector<SeenLandmark>> FindLandmarks(
    const KeyframeMap& map, const CalibrationData& chosen,
    FrontendOptions options, int max_features, int threads) {
  options.camera = map.camera;
  options.max_features = max_features;
  const int num_keyframes = static_cast<int>(chosen.in_map.size());
  const std::vector<bool> is_held_out = HeldOut(num_keyframes, chosen.pairs);
  std::vector<std::vector<std::pair<int, bool>>> neighbours(num_keyframes);
  for (size_t i = 0; i < chosen.pairs.size(); ++i) {
    const auto [a, b] = chosen.pairs[i];
    neighbours[a].emplace_back(b, is_held_out[i]);
    neighbours[b].emplace_back(a, is_held_out[i]);
  }
  std::vector<std::vector<SeenLandmark>> found(num_keyframes);
  threads = std::max(1, std::min(threads, num_keyframes));
  ParallelFor(threads, threads, [&](int thread) {
    // Each thread has consecutive keyframes, because they share decoded
    // neighbours.
    LandmarkMatcher matcher(map, chosen.in_map, options);
    const int begin = thread * num_keyframes / threads;
    const int end = (thread + 1) * num_keyframes / threads;
    for (int i = begin; i < end; ++i) {
      found[i] = matcher.Match(i, neighbours[i]);
    }
  });
  return found;
}

// Adds as many landmarks as `max_views` allows.
void AddLandmarks(const std::vector<std::vector<SeenLandmark>>& found,
                  int max_views, CalibrationViews* views) {
  size_t all_views = 0;
  for (const auto& of_keyframe : found) {
    for (const SeenLandmark& seen : of_keyframe) all_views += seen.views.size();
  }
  const double share =
      std::min(1.0, max_views / std::max(1.0, static_cast<double>(all_views)));
  for (const auto& of_keyframe : found) {
    // They are chosen evenly, because they are ordered by their position in the
    // image.
    const auto count =
        static_cast<size_t>(std::ceil(share * of_keyframe.size()));
    for (size_t chosen = 0; chosen < count; ++chosen) {
      const auto& [landmark, own] =
          of_keyframe[chosen * of_keyframe.size() / count];
      views->landmarks.push_back(landmark);
      views->landmarks.back().first_view =
          static_cast<int>(views->views.size());
      views->landmarks.back().num_views = static_cast<int>(own.size());
      views->views.insert(views->views.end(), own.begin(), own.end());
    }
  }
}

}  // namespace

CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const FrontendOptions& features,
                                       int max_views, int threads) {
  CalibrationData data;
  data.in_map = ChosenKeyframes(map);
  data.views.camera = map.camera;
  std::map<int, int> number_of;  // by keyframe id
  for (const int place : data.in_map) {
    const Keyframe& keyframe = map.keyframes[place];
    number_of[keyframe.id] = static_cast<int>(data.timestamps.size());
    data.timestamps.push_back(keyframe.images.timestamp);
    data.views.world_from_cam.push_back(keyframe.world_from_cam);
    data.views.twists.push_back(TwistAt(path, keyframe.images.timestamp));
  }
  std::set<std::array<int, 2>> pairs;  // their distance, the first keyframe
  for (const RelativePose& edge : map.edges) {
    const auto a = number_of.find(edge.ref), b = number_of.find(edge.cur);
    if (a == number_of.end() || b == number_of.end()) continue;
    pairs.insert(
        {std::abs(a->second - b->second), std::min(a->second, b->second)});
  }
  for (const auto& [distance, first] : pairs) {
    data.pairs.push_back({first, first + distance});
  }
  // The number of features per keyframe is chosen for the requested number of
  // views, since only a share of the features is found again, but it does not
  // fall below the number that covers the whole image.
  constexpr double kMostFeatures = 300.0, kFewestFeatures = 80.0;
  constexpr double kFoundAgain = 0.2;
  const double in_each = max_views / (kFoundAgain * 2.0 *
                                      std::max<double>(1.0, data.pairs.size()));
  const int max_features =
      static_cast<int>(std::clamp(in_each, kFewestFeatures, kMostFeatures));
  AddLandmarks(FindLandmarks(map, data, features, max_features, threads),
               max_views, &data.views);
  return data;
}

}  // namespace rgbd_pose
