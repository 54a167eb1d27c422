#include "apps/calibration/calibration_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/parallel_for.h"
#include "frontend/features/frontend.h"
#include "frontend/image/depth_mover.h"
#include "frontend/image/depth_plane.h"
#include "frontend/image/observe.h"

namespace rgbd_pose {
namespace {

// Of a keyframe: as many as make the views that are wanted, since only some are
// found again, but no fewer than lie all over the image.
constexpr int kMostFeatures = 300;
constexpr int kFewestFeatures = 80;
constexpr double kFoundAgain = 0.2;

// Longer than this between two frames, a velocity is not known.
constexpr double kMaxGap = 0.15;  // s

using Velocity = CameraVelocity;

// Of points in the axes of the camera: central differences of the fourth order,
// where frames follow each other evenly.
Velocity VelocityAt(const Trajectory& path, double time) {
  const auto at = std::lower_bound(
      path.begin(), path.end(), time - 1e-4,
      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  Velocity velocity;
  if (at == path.end()) return velocity;
  // The last frame that comes so many after, without a gap.
  const auto place = at - path.begin();
  const auto neighbour = [&](int steps) {
    const int direction = steps > 0 ? 1 : -1;
    auto there = place;
    for (int i = 0; i < std::abs(steps); ++i) {
      const auto next = there + direction;
      if (next < 0 || next >= static_cast<std::ptrdiff_t>(path.size()) ||
          std::abs(path[next].timestamp - path[there].timestamp) > kMaxGap) {
        break;
      }
      there = next;
    }
    return there;
  };
  struct Difference {
    Velocity velocity;
    double interval = 0.0;  // s
    double lean = 0.0;      // how far its middle is from the frame, s
  };
  const auto moved = [&](std::ptrdiff_t there) {
    const Rigid3d from_at =
        path[there].world_from_cam.Inverse() * at->world_from_cam;
    const Eigen::AngleAxisd turn(from_at.rotation);
    return Velocity{turn.angle() * turn.axis(), from_at.translation};
  };
  const auto difference = [&](int steps) {
    const auto before = neighbour(-steps), after = neighbour(steps);
    const double t0 = path[before].timestamp, t1 = path[after].timestamp;
    Difference result;
    result.interval = t1 - t0;
    result.lean = std::abs(0.5 * (t0 + t1) - at->timestamp);
    if (!(result.interval > 0.0)) return result;
    const Velocity a = moved(before), b = moved(after);
    result.velocity.rotation = (b.rotation - a.rotation) / result.interval;
    result.velocity.translation =
        (b.translation - a.translation) / result.interval;
    return result;
  };
  const Difference near = difference(1);
  const Difference far = difference(2);
  constexpr double kEven = 0.05;
  const bool is_even = std::abs(far.interval / near.interval - 2.0) < kEven &&
                       std::max(near.lean, far.lean) < kEven * near.interval;
  velocity = near.velocity;
  if (is_even) {
    velocity.rotation += (near.velocity.rotation - far.velocity.rotation) / 3.0;
    velocity.translation +=
        (near.velocity.translation - far.velocity.translation) / 3.0;
  }
  return velocity;
}

// The largest segment's keyframes, by their places in the map.
std::vector<int> ChosenKeyframes(const KeyframeMap& map, int most) {
  std::map<int, std::vector<int>> segments;
  for (size_t i = 0; i < map.keyframes.size(); ++i) {
    segments[map.keyframes[i].segment].push_back(static_cast<int>(i));
  }
  std::vector<int> largest;
  for (const auto& [segment, members] : segments) {
    if (members.size() > largest.size()) largest = members;
  }
  std::sort(largest.begin(), largest.end(), [&](int a, int b) {
    return map.keyframes[a].images.timestamp <
           map.keyframes[b].images.timestamp;
  });
  if (static_cast<int>(largest.size()) <= most) return largest;
  std::vector<int> chosen;
  for (int i = 0; i < most; ++i) {
    chosen.push_back(largest[i * largest.size() / most]);
  }
  return chosen;
}

// What an observation says of depth. Nothing where the surface is no plane.
MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const Velocity& velocity,
                                const DepthNoiseModel& noise) {
  MeasuredInverseDepth depth;
  if (o.depth <= 0.0) return depth;
  depth.value = 1.0 / o.depth;
  depth.plane = LookUpPlane(frame, camera, pixel.x(), pixel.y(), noise);
  if (depth.plane.isZero(0.0)) return depth;
  depth.ray = camera.Ray(o.u, o.v);
  depth.inverse_sigma = o.depth * o.depth / o.sigma_depth;
  depth.rate_rotation = velocity.rotation;
  depth.rate_translation = velocity.translation;
  const Eigen::Vector2d middle(std::round(pixel.x()), std::round(pixel.y()));
  const double at_middle =
      frame.DepthAt(static_cast<int>(middle.x()), static_cast<int>(middle.y()));
  if (at_middle > 0.0) {
    const Eigen::Vector2d ideal = camera.Undistort(middle);
    depth.pixel_value = 1.0 / at_middle;
    depth.pixel_ray = camera.Ray(ideal.x(), ideal.y());
  }
  return depth;
}

// The landmarks of one keyframe, with its views still its own.
struct OfKeyframe {
  std::vector<Landmark> landmarks;
  std::vector<std::vector<LandmarkView>> views;
};

// What one thread works with.
class Matcher {
 public:
  Matcher(const KeyframeMap& map, const std::vector<int>& chosen,
          const std::vector<Velocity>& velocities,
          const OdometrySettings& settings, int max_features)
      : map_(map), chosen_(chosen), velocities_(velocities) {
    FrontendOptions options = settings.features;
    options.camera = map.camera;
    options.max_features = max_features;
    frontend_ = MakeFrontend("patch", options);
    noise_ = options.depth_noise;
  }

  // `held_out`: of each of the neighbours.
  OfKeyframe Match(int anchor, const std::vector<int>& neighbours,
                   const std::vector<bool>& held_out) {
    OfKeyframe result;
    const Frame frame = Images(anchor).first;
    const auto features = frontend_->Detect(*Images(anchor).second);
    std::vector<int> place(features->observations.size(), -1);
    for (size_t i = 0; i < features->observations.size(); ++i) {
      const Observation& o = features->observations[i];
      const Eigen::Vector2d pixel = Seen(o);
      Landmark landmark;
      landmark.anchor = anchor;
      landmark.u = pixel.x();
      landmark.v = pixel.y();
      landmark.depth =
          MeasuredAt(frame, map_.camera, o, pixel, velocities_[anchor], noise_);
      if (landmark.depth.inverse_sigma == 0.0) continue;
      place[i] = static_cast<int>(result.landmarks.size());
      result.landmarks.push_back(landmark);
    }
    result.views.resize(result.landmarks.size());
    for (size_t n = 0; n < neighbours.size(); ++n) {
      const int to = neighbours[n];
      const auto& [there, prepared] = Images(to);
      const Rigid3d cur_from_ref = Pose(to).Inverse() * Pose(anchor);
      frontend_->Match(*features, *prepared, cur_from_ref, &matches_);
      for (size_t i = 0; i < matches_.matches.size(); ++i) {
        const int landmark = place[matches_.features[i]];
        if (landmark < 0) continue;
        const Observation& o = matches_.matches[i].cur;
        const Eigen::Vector2d pixel = Seen(o);
        LandmarkView view;
        view.keyframe = to;
        view.u = pixel.x();
        view.v = pixel.y();
        view.sigma_px = o.sigma_px;
        view.depth =
            MeasuredAt(there, map_.camera, o, pixel, velocities_[to], noise_);
        view.is_held_out = held_out[n];
        result.views[landmark].push_back(view);
      }
    }
    return result;
  }

 private:
  using Both = std::pair<Frame, std::unique_ptr<const PreparedFrame>>;

  const Rigid3d& Pose(int at) const {
    return map_.keyframes[chosen_[at]].map_from_cam;
  }
  // Decoded once for neighbours that follow each other.
  const Both& Images(int at) {
    constexpr size_t kMost = 40;
    const auto found = images_.find(at);
    if (found != images_.end()) return found->second;
    if (images_.size() >= kMost) {
      // The farthest in time will be needed last.
      auto farthest = images_.begin();
      for (auto it = images_.begin(); it != images_.end(); ++it) {
        if (std::abs(it->first - at) > std::abs(farthest->first - at)) {
          farthest = it;
        }
      }
      images_.erase(farthest);
    }
    Frame frame = map_.keyframes[chosen_[at]].images.Restore();
    auto prepared = frontend_->Prepare(frame);
    return images_.emplace(at, Both(std::move(frame), std::move(prepared)))
        .first->second;
  }
  // The pixel that was measured.
  Eigen::Vector2d Seen(const Observation& o) const {
    return map_.camera.Project(map_.camera.Ray(o.u, o.v));
  }

  const KeyframeMap& map_;
  const std::vector<int>& chosen_;
  const std::vector<Velocity>& velocities_;
  std::unique_ptr<Frontend> frontend_;
  DepthNoiseModel noise_;
  std::map<int, Both> images_;
  FeatureMatches matches_;
};

// Every so-manieth pair, but none that two keyframes hang together by.
std::vector<bool> HeldOut(int num_keyframes,
                          const std::vector<std::array<int, 2>>& pairs,
                          int every) {
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
    if (a == b) {
      spare.push_back(i);
    } else {
      root[a] = b;
    }
  }
  // One in `every` of all, as far as there are any to spare.
  const double step =
      std::max(1.0, static_cast<double>(spare.size()) * every / pairs.size());
  for (double i = 0.0; i < spare.size(); i += step) {
    held_out[spare[static_cast<size_t>(i)]] = true;
  }
  return held_out;
}

// Looks a depth up in an image in which a displacement has been undone.
void LookUpAnew(const Frame& frame, const Camera& camera,
                const DepthLookupOptions& options, double u, double v,
                const Velocity& undone, MeasuredInverseDepth* depth) {
  const Observation o = Observe(frame, camera, u, v, 1.0, options);
  const Velocity velocity{depth->rate_rotation, depth->rate_translation};
  MeasuredInverseDepth anew =
      MeasuredAt(frame, camera, o, {u, v}, velocity, options.noise);
  anew.undone_rotation = undone.rotation;
  anew.undone_translation = undone.translation;
  // A landmark keeps a value to begin with.
  if (anew.inverse_sigma == 0.0) anew.value = depth->value;
  *depth = anew;
}

}  // namespace

std::string CalibrationDataOptions::Check() const {
  if (max_views < 1000) return "max_views must be at least 1000";
  if (max_keyframes < 2) return "max_keyframes must be at least 2";
  if (hold_out < 2) return "hold_out must be at least 2";
  return "";
}

CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const OdometrySettings& settings,
                                       const CalibrationDataOptions& options,
                                       int threads) {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("calibration: " + error);
  const std::vector<int> chosen = ChosenKeyframes(map, options.max_keyframes);
  const int num_keyframes = static_cast<int>(chosen.size());
  CalibrationData data;
  data.views.camera = map.camera;
  data.in_map = chosen;
  std::map<int, int> number_of;  // by the map's id
  std::vector<Velocity> velocities;
  for (int i = 0; i < num_keyframes; ++i) {
    const MapKeyframe& keyframe = map.keyframes[chosen[i]];
    number_of[keyframe.id] = i;
    data.views.world_from_cam.push_back(keyframe.map_from_cam);
    data.timestamps.push_back(keyframe.images.timestamp);
    velocities.push_back(VelocityAt(path, keyframe.images.timestamp));
  }
  for (const Edge& edge : map.edges) {
    const auto a = number_of.find(edge.ref), b = number_of.find(edge.cur);
    if (a == number_of.end() || b == number_of.end()) continue;
    data.pairs.push_back(
        {std::min(a->second, b->second), std::max(a->second, b->second)});
  }
  std::sort(data.pairs.begin(), data.pairs.end(), [](auto& a, auto& b) {
    return std::make_pair(a[1] - a[0], a[0]) <
           std::make_pair(b[1] - b[0], b[0]);
  });
  data.pairs.erase(std::unique(data.pairs.begin(), data.pairs.end()),
                   data.pairs.end());
  const std::vector<bool> held_out =
      HeldOut(num_keyframes, data.pairs, options.hold_out);
  std::vector<std::vector<int>> neighbours(num_keyframes);
  std::vector<std::vector<bool>> is_held_out(num_keyframes);
  for (size_t i = 0; i < data.pairs.size(); ++i) {
    const auto [a, b] = data.pairs[i];
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
    is_held_out[a].push_back(held_out[i]);
    is_held_out[b].push_back(held_out[i]);
  }

  data.velocities = velocities;

  const double in_each =
      options.max_views /
      (kFoundAgain * 2.0 * std::max<double>(1.0, data.pairs.size()));
  const int features = static_cast<int>(
      std::clamp<double>(in_each, kFewestFeatures, kMostFeatures));
  std::vector<OfKeyframe> found(num_keyframes);
  threads = std::max(1, std::min(threads, num_keyframes));
  ParallelFor(threads, threads, [&](int thread) {
    // A run of keyframes each: neighbours are decoded once.
    Matcher matcher(map, chosen, velocities, settings, features);
    const int begin = thread * num_keyframes / threads;
    const int end = (thread + 1) * num_keyframes / threads;
    for (int i = begin; i < end; ++i) {
      found[i] = matcher.Match(i, neighbours[i], is_held_out[i]);
    }
  });
  size_t all_views = 0;
  for (const OfKeyframe& keyframe : found) {
    for (const auto& views : keyframe.views) all_views += views.size();
  }
  const double share =
      all_views == 0 ? 1.0
                     : std::min(1.0, static_cast<double>(options.max_views) /
                                         static_cast<double>(all_views));
  for (const OfKeyframe& keyframe : found) {
    std::vector<size_t> seen;  // again
    for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.views[i].empty()) seen.push_back(i);
    }
    // Evenly chosen: they are in the order of their places in the image.
    const auto count = static_cast<size_t>(std::ceil(share * seen.size()));
    for (size_t chosen = 0; chosen < count; ++chosen) {
      const size_t i = seen[chosen * seen.size() / count];
      Landmark landmark = keyframe.landmarks[i];
      landmark.first_view = static_cast<int>(data.views.views.size());
      landmark.num_views = static_cast<int>(keyframe.views[i].size());
      data.views.landmarks.push_back(landmark);
      data.views.views.insert(data.views.views.end(), keyframe.views[i].begin(),
                              keyframe.views[i].end());
    }
  }
  return data;
}

void LookUpDepthsAnew(const KeyframeMap& map, const Camera& camera,
                      const OdometrySettings& settings,
                      const CalibrationVector& theta, int threads,
                      CalibrationData* data) {
  FrontendOptions features = settings.features;
  features.camera = camera;
  const DepthLookupOptions options = features.DepthLookup();
  const int num_keyframes = static_cast<int>(data->in_map.size());
  // By keyframe: its own landmarks, and what it sees of others.
  std::vector<std::vector<Landmark*>> landmarks(num_keyframes);
  std::vector<std::vector<LandmarkView*>> views(num_keyframes);
  for (Landmark& landmark : data->views.landmarks) {
    landmarks[landmark.anchor].push_back(&landmark);
  }
  for (LandmarkView& view : data->views.views) {
    views[view.keyframe].push_back(&view);
  }
  ParallelFor(num_keyframes, threads, [&](int k) {
    if (landmarks[k].empty() && views[k].empty()) return;
    const double delay = theta[kDepthTime];
    const Velocity& velocity = data->velocities[k];
    const Velocity moved = {
        theta.segment<3>(kRotationX) + delay * velocity.rotation,
        theta.segment<3>(kTranslationX) + delay * velocity.translation};
    const double angle = moved.rotation.norm();
    const Eigen::Vector3d axis = angle > 0.0
                                     ? Eigen::Vector3d(moved.rotation / angle)
                                     : Eigen::Vector3d::UnitX();
    const Rigid3d measured_from_moved(
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), moved.translation);
    Frame frame = map.keyframes[data->in_map[k]].images.Restore();
    frame.depth =
        DepthMover(camera).Move(frame, measured_from_moved.Inverse()).clone();
    for (Landmark* landmark : landmarks[k]) {
      LookUpAnew(frame, camera, options, landmark->u, landmark->v, moved,
                 &landmark->depth);
    }
    for (LandmarkView* view : views[k]) {
      LookUpAnew(frame, camera, options, view->u, view->v, moved, &view->depth);
    }
  });
}

}  // namespace rgbd_pose
