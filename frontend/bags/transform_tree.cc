#include "frontend/bags/transform_tree.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {

void TransformTree::Add(const std::vector<RosTransform>& transforms) {
  for (const auto& [header, child, parent_from_child] : transforms) {
    const auto& [stamp, parent] = header;
    Edge& edge = edges_[std::string(child)];
    if (edge.parent != parent) edge = Edge{std::string(parent), false, {}};
    Trajectory& samples = edge.samples;
    if (!edge.moves && !samples.empty() &&
        samples.front().world_from_cam == parent_from_child) {
      if (samples.size() == 1) samples.push_back(samples.front());
      samples.front().timestamp = std::min(samples.front().timestamp, stamp);
      samples.back().timestamp = std::max(samples.back().timestamp, stamp);
      continue;
    }
    edge.moves = !samples.empty();
    const auto place = std::lower_bound(
        samples.begin(), samples.end(), stamp,
        [](const StampedPose& pose, double at) { return pose.timestamp < at; });
    if (place != samples.end() && place->timestamp == stamp) continue;
    samples.insert(place, {stamp, parent_from_child});
  }
}

std::vector<std::pair<std::string, Rigid3d>> TransformTree::FixedAbove(
    const std::string& frame) const {
  std::vector<std::pair<std::string, Rigid3d>> above = {{frame, Rigid3d()}};
  while (above.size() <= edges_.size()) {
    const auto& [name, name_from_frame] = above.back();
    const auto edge = edges_.find(name);
    if (edge == edges_.end() || edge->second.moves) break;
    above.emplace_back(
        edge->second.parent,
        edge->second.samples.front().world_from_cam * name_from_frame);
  }
  return above;
}

std::optional<Rigid3d> TransformTree::Fixed(const std::string& target,
                                            const std::string& source) const {
  const auto above_source = FixedAbove(source);
  for (const auto& [common, common_from_target] : FixedAbove(target)) {
    for (const auto& [name, name_from_source] : above_source) {
      if (name != common) continue;
      return common_from_target.Inverse() * name_from_source;
    }
  }
  return std::nullopt;
}

Trajectory TransformTree::PathOf(const std::string& world,
                                 const std::string& frame) const {
  constexpr double kAnyGap = INFINITY;  // s
  std::vector<const Edge*> edges;       // from the frame up to the world
  const Edge* most = nullptr;           // that moves, with most samples
  for (const std::string* at = &frame; *at != world;) {
    const auto found = edges_.find(*at);
    // The limit ends the loop if the frames form a cycle.
    if (found == edges_.end() || edges.size() == edges_.size()) return {};
    const Edge& edge = found->second;
    if (edge.moves &&
        (most == nullptr || edge.samples.size() > most->samples.size())) {
      most = &edge;
    }
    edges.push_back(&edge);
    at = &edge.parent;
  }
  if (most == nullptr) return {};
  Trajectory path;
  for (const StampedPose& sample : most->samples) {
    std::optional<Rigid3d> pose = Rigid3d();
    for (const Edge* edge : edges) {
      const std::optional<Rigid3d> step =
          edge->moves
              ? InterpolatedPose(edge->samples, sample.timestamp, kAnyGap)
              : edge->samples.front().world_from_cam;
      pose = pose && step ? std::optional(*step * *pose) : std::nullopt;
    }
    if (pose.has_value()) path.push_back({sample.timestamp, *pose});
  }
  return path;
}

}  // namespace rgbd_pose
