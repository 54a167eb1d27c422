#include "frontend/slam/keyframe_graph.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rgbd_pose {
namespace {

// The covariance of the inverse of a motion from that of the motion itself,
// both of [omega C] as in MotionEstimate. With the translation t of the motion,
// errors are to first order, up to their common sign,
//
//   omega' = R^T omega,   C' = R C + t x omega
MotionMatrix CovarianceOfInverse(const RelativePose& edge) {
  const Eigen::Matrix3d R = edge.cur_from_ref.rotation.toRotationMatrix();
  MotionMatrix by_motion = MotionMatrix::Zero();
  by_motion.topLeftCorner<3, 3>() = R.transpose();
  by_motion.bottomLeftCorner<3, 3>() =
      CrossMatrix(edge.cur_from_ref.translation);
  by_motion.bottomRightCorner<3, 3>() = R;
  return by_motion * edge.covariance * by_motion.transpose();
}

}  // namespace

void CovisibilityGraph::Join(int a, int b) {
  neighbors_[a].push_back(b);
  neighbors_[b].push_back(a);
}

void CovisibilityGraph::Separate(int at) {
  for (const int other : neighbors_[at]) {
    std::vector<int>& theirs = neighbors_[other];
    theirs.erase(std::remove(theirs.begin(), theirs.end(), at), theirs.end());
  }
  neighbors_[at].clear();
}

bool CovisibilityGraph::AreJoined(int a, int b) const {
  return std::find(neighbors_[a].begin(), neighbors_[a].end(), b) !=
         neighbors_[a].end();
}

std::vector<int> CovisibilityGraph::Reach(int from, std::vector<int>* before,
                                          int hops) const {
  std::vector<int> reached = {from};
  (*before)[from] = from;
  size_t next = 0;
  for (int hop = 0; hop < hops && next < reached.size(); ++hop) {
    for (const size_t end = reached.size(); next < end; ++next) {
      const int at = reached[next];
      for (const int other : neighbors_[at]) {
        if ((*before)[other] >= 0) continue;
        (*before)[other] = at;
        reached.push_back(other);
      }
    }
  }
  return reached;
}

std::vector<bool> CovisibilityGraph::Within(int from, int hops) const {
  std::vector<int> before(neighbors_.size(), -1);
  std::vector<bool> within(neighbors_.size(), false);
  for (const int at : Reach(from, &before, hops)) within[at] = true;
  return within;
}

std::vector<int> CovisibilityGraph::ShortestPath(int from, int to) const {
  std::vector<int> before(neighbors_.size(), -1);
  Reach(from, &before);
  if (before[to] < 0) return {};
  std::vector<int> way = {to};
  while (way.back() != from) way.push_back(before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

std::vector<int> CovisibilityGraph::FirstOfParts() const {
  std::vector<int> first(neighbors_.size()), before(neighbors_.size(), -1);
  for (int from = 0; from < static_cast<int>(first.size()); ++from) {
    if (before[from] >= 0) continue;
    for (const int at : Reach(from, &before)) first[at] = from;
  }
  return first;
}

bool CovisibilityGraph::StaysConnectedWithout(int without) const {
  constexpr int kHopsAround = 3;
  const std::vector<int>& around = neighbors_[without];
  if (around.empty()) return false;
  std::vector<int> before(neighbors_.size(), -1);
  before[without] = without;
  Reach(around.front(), &before, kHopsAround);
  return std::all_of(around.begin(), around.end(),
                     [&](int at) { return before[at] >= 0; });
}

int KeyframeGraph::Add(const Rigid3d& map_from_cam, int segment, bool is_held) {
  nodes_.push_back({map_from_cam, segment, is_held, /*from_anchor=*/{}});
  links_.Add();
  first_of_.emplace(segment, size() - 1);
  return size() - 1;
}

void KeyframeGraph::AddPair(const RelativePose& edge, bool is_tracked,
                            bool is_loop) {
  pairs_.push_back({edge, is_tracked, is_loop});
  links_.Join(edge.ref, edge.cur);
}

bool KeyframeGraph::Join(const RelativePose& edge) {
  int from = segment(edge.cur), to = segment(edge.ref);
  Rigid3d to_from_from =
      pose(edge.ref) * edge.cur_from_ref.Inverse() * pose(edge.cur).Inverse();
  const auto is_held = [this](int whole) {
    return nodes_[first_of_.at(whole)].is_held;
  };
  if (is_held(from)) {
    if (is_held(to)) return false;
    std::swap(from, to);
    to_from_from = to_from_from.Inverse();
  }
  for (Node& node : nodes_) {
    if (node.segment != from) continue;
    node.segment = to;
    node.map_from_cam = to_from_from * node.map_from_cam;
  }
  first_of_.erase(from);
  return true;
}

bool KeyframeGraph::IsRedundant(int at) const {
  return !IsFixed(at) && links_.StaysConnectedWithout(at);
}

void KeyframeGraph::Remove(int at, int anchor) {
  RelativePose from_anchor = {anchor, at, CurFromRef(anchor, at)};
  const auto links = [](const MapEdge& pair, int which) {
    return pair.ref == which || pair.cur == which;
  };
  for (const MapEdge& pair : pairs_) {
    if (!links(pair, at) || !links(pair, anchor)) continue;
    RelativePose edge = pair;
    // The pairs of a map that was loaded may lead to earlier keyframes.
    if (edge.ref == at) edge.covariance = CovarianceOfInverse(edge);
    from_anchor.covariance = CovarianceOf(edge);
  }
  nodes_[at].from_anchor = from_anchor;
  links_.Separate(at);
  pairs_.erase(
      std::remove_if(pairs_.begin(), pairs_.end(),
                     [&](const auto& pair) { return links(pair, at); }),
      pairs_.end());
}

RelativePose KeyframeGraph::Reanchor(RelativePose edge) const {
  while (IsRemoved(edge.ref)) {
    const RelativePose& step = *nodes_[edge.ref].from_anchor;
    edge.covariance = ComposedCovariance(edge.cur_from_ref, edge.covariance,
                                         step.cur_from_ref, step.covariance);
    edge.cur_from_ref = edge.cur_from_ref * step.cur_from_ref;
    edge.ref = step.ref;
  }
  return edge;
}

struct KeyframeGraph::Problem {
  PoseGraph graph;
  std::vector<int> pose_of;  // by keyframe; -1: none
};

KeyframeGraph::Problem KeyframeGraph::Build(const std::vector<int>& free,
                                            bool graduated) const {
  PoseGraphOptions options;
  options.graduated = graduated;
  options.step_tolerance = 1e-5;
  // Poses connected only by an uncertain motion must not make the solver fail.
  options.max_standard_deviation = 1e3;
  Problem problem{PoseGraph(options), std::vector<int>(nodes_.size(), -1)};
  const auto add = [&](int at, bool is_fixed) {
    if (problem.pose_of[at] < 0) {
      problem.pose_of[at] = problem.graph.AddPose(pose(at), is_fixed);
    }
  };
  // A component without a fixed pose must not make it fail either, so the first
  // keyframe of each is fixed, too.
  const std::vector<int> first = links_.FirstOfParts();
  std::vector<bool> is_held(nodes_.size(), false);
  for (int at = 0; at < size(); ++at) {
    if (IsFixed(at)) is_held[first[at]] = true;
  }
  std::vector<bool> is_free(nodes_.size(), false);
  for (const int at : free) {
    is_free[at] = !IsFixed(at) && (first[at] != at || is_held[at]);
    add(at, !is_free[at]);
  }
  for (const MapEdge& pair : pairs_) {
    RelativePose edge = pair;
    if (!is_free[edge.ref] && !is_free[edge.cur]) continue;
    add(edge.ref, true);
    add(edge.cur, true);
    edge.covariance = CovarianceInGraph(pair);
    edge.ref = problem.pose_of[edge.ref];
    edge.cur = problem.pose_of[edge.cur];
    problem.graph.AddEdge(edge, LossOf(pair));
  }
  AddUps(is_free, &problem);
  return problem;
}

// Each segment has an upright frame of its own, which is estimated as well:
// from all of its keyframes, also those that stay where they are.
void KeyframeGraph::AddUps(const std::vector<bool>& is_free,
                           Problem* problem) const {
  struct Segment {
    Eigen::Vector3d up = Eigen::Vector3d::Zero();  // a sum
    bool is_free = false;
    int upright = -1;  // its number in the problem
  };
  const auto has_up = [this](int at) {
    return nodes_[at].up.has_value() && !IsRemoved(at);
  };
  std::map<int, Segment> segments;
  for (int at = 0; at < size(); ++at) {
    if (!has_up(at)) continue;
    Segment* const whole = &segments[segment(at)];
    whole->up += pose(at).rotation * nodes_[at].up->in_cam;
    whole->is_free |= is_free[at];
  }
  const auto number = [&](int at) {
    int* const known = &problem->pose_of[at];
    if (*known < 0) *known = problem->graph.AddPose(pose(at), true);
    return *known;
  };
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  for (int at = 0; at < size(); ++at) {
    if (!has_up(at)) continue;
    Segment* const whole = &segments[segment(at)];
    if (!whole->is_free) continue;
    if (whole->upright < 0) {
      const int first = first_of_.at(segment(at));
      const Rigid3d map_from_upright(
          Eigen::Quaterniond::FromTwoVectors(z, whole->up),
          pose(first).translation);
      whole->upright = problem->graph.AddPose(map_from_upright);
      // As good as unknown: it only keeps what nothing measures where it is.
      RelativePose loose;
      loose.ref = number(first);
      loose.cur = whole->upright;
      loose.cur_from_ref = map_from_upright.Inverse() * pose(first);
      loose.covariance.setIdentity();
      problem->graph.AddEdge(loose);
    }
    const Up& up = *nodes_[at].up;
    problem->graph.AddDirection(number(at), whole->upright,
                                {up.in_cam, z, up.sigma}, pair_loss_.get());
  }
}

std::string KeyframeGraph::Solve(const std::vector<int>& free, bool graduated) {
  Problem problem = Build(free, graduated);
  const GraphSolution solution = problem.graph.Solve();
  if (!solution.ok()) return solution.reason;
  for (const int at : free) {
    nodes_[at].map_from_cam = problem.graph.pose(problem.pose_of[at]);
  }
  // An anchor may be removed as well, but it is older and updated first.
  for (Node& node : nodes_) {
    if (!node.from_anchor.has_value()) continue;
    const RelativePose& step = *node.from_anchor;
    node.map_from_cam = pose(step.ref) * step.cur_from_ref.Inverse();
    node.segment = segment(step.ref);
  }
  return "";
}

std::string KeyframeGraph::SolveNear(int newest) {
  std::vector<int> free;
  for (int at = newest; at >= 0 && static_cast<int>(free.size()) < window_;
       --at) {
    if (!IsRemoved(at)) free.push_back(at);
  }
  const int oldest = free.back();
  for (const int at : links_.Neighbors(newest)) {
    if (at < oldest) free.push_back(at);
  }
  return Solve(free, /*graduated=*/false);
}

std::vector<int> KeyframeGraph::All() const {
  std::vector<int> all;
  for (int at = 0; at < size(); ++at) {
    if (!IsRemoved(at)) all.push_back(at);
  }
  return all;
}

// The proportional error is fitted alternately with the poses.
std::string KeyframeGraph::SolveAll() {
  constexpr int kMaxRounds = 4;
  std::string error = Solve(All(), /*graduated=*/true);
  for (int round = 1; round < kMaxRounds && error.empty(); ++round) {
    const double before = proportional_error_;
    FitProportionalError();
    if (proportional_error_ == before) break;
    error = Solve(All(), /*graduated=*/true);
    if (std::abs(proportional_error_ - before) <= 0.1 * before) break;
  }
  return error;
}

std::vector<MotionMatrix> KeyframeGraph::Covariances() const {
  const std::vector<int> all = All();
  const Problem problem = Build(all, /*graduated=*/false);
  std::vector<int> poses;
  for (const int at : all) poses.push_back(problem.pose_of[at]);
  std::vector<MotionMatrix> covariances =
      problem.graph.MarginalCovariances(poses);
  const double factor = problem.graph.OvercountingFactor();
  for (MotionMatrix& covariance : covariances) covariance *= factor;
  return covariances;
}

}  // namespace rgbd_pose
