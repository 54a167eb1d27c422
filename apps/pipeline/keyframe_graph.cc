#include "apps/pipeline/keyframe_graph.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

// Losses of pairs, in sigmas: the odometry's own are hardly ever wrong.
constexpr double kTrackedWidth = 5.0;
constexpr double kPairWidth = 3.0;

// A wrong rotation displaces what is seen at this distance (m).
constexpr double kTypicalDepth = 2.0;

// The median of chi^2 of six degrees, and its 99.9 % quantile.
constexpr double kMedianSquare = 5.35;
constexpr double kLargestSquare = 22.46;

// Slack is measured by so many pairs at least, and in turns with the poses.
constexpr int kMinPairsForSlack = 20;
constexpr int kMaxSlackRounds = 4;
constexpr double kMaxSlack = 0.1;

// A keyframe may be dropped if those around it are so near to each other.
constexpr int kHopsAround = 3;

// Of a motion against another: omega (rad) about the current axes, and C (m).
MotionVector Difference(const Rigid3d& motion, const Rigid3d& other) {
  const Eigen::AngleAxisd omega(motion.rotation * other.rotation.conjugate());
  MotionVector e;
  e << omega.angle() * omega.axis(),
      motion.Inverse().translation - other.Inverse().translation;
  return e;
}

}  // namespace

std::string KeyframeGraphOptions::Check() const {
  if (window < 1) return "window must be at least 1";
  if (!(min_sigma_rotation >= 0.0) || !(min_sigma_translation >= 0.0)) {
    return "standard deviations must not be negative";
  }
  if (!(drift > 0.0)) return "drift must be positive";
  return "";
}

KeyframeGraph::KeyframeGraph(const KeyframeGraphOptions& options)
    : options_(options),
      tracked_loss_(FindMEstimator("huber")->make(kTrackedWidth)),
      pair_loss_(FindMEstimator("cauchy")->make(kPairWidth)) {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("graph: " + error);
}

int KeyframeGraph::Add(const Rigid3d& map_from_cam, int segment, bool is_held) {
  Node node;
  node.map_from_cam = map_from_cam;
  node.segment = segment;
  node.is_held = is_held;
  nodes_.push_back(std::move(node));
  first_of_.emplace(segment, size() - 1);
  return size() - 1;
}

bool KeyframeGraph::AreJoined(int a, int b) const {
  const std::vector<int>& beside = nodes_[a].neighbours;
  return std::find(beside.begin(), beside.end(), b) != beside.end();
}

void KeyframeGraph::AddPair(const Edge& edge, bool is_tracked, bool is_loop) {
  pairs_.push_back({edge, is_tracked, is_loop});
  nodes_[edge.ref].neighbours.push_back(edge.cur);
  nodes_[edge.cur].neighbours.push_back(edge.ref);
}

std::vector<bool> KeyframeGraph::Within(int from, int hops) const {
  std::vector<bool> seen(nodes_.size(), false);
  std::vector<int> reached = {from};
  seen[from] = true;
  size_t next = 0;
  for (int hop = 0; hop < hops; ++hop) {
    for (const size_t end = reached.size(); next < end; ++next) {
      for (const int beside : nodes_[reached[next]].neighbours) {
        if (!seen[beside]) reached.push_back(beside);
        seen[beside] = true;
      }
    }
  }
  return seen;
}

int KeyframeGraph::Hops(int from, int to, int most) const {
  std::vector<int> reached = {from};
  std::vector<bool> seen(nodes_.size(), false);
  seen[from] = true;
  for (int hops = 0; hops < most; ++hops) {
    std::vector<int> next;
    for (const int at : reached) {
      if (at == to) return hops;
      for (const int beside : nodes_[at].neighbours) {
        if (!seen[beside]) next.push_back(beside);
        seen[beside] = true;
      }
    }
    reached = std::move(next);
  }
  return most;
}

// The way with the fewest pairs; along it errors add up, and an error of the
// rotation swings all that follows.
bool KeyframeGraph::IsPlausible(const Edge& edge) const {
  std::vector<int> before(nodes_.size(), -1), reached = {edge.ref};
  before[edge.ref] = edge.ref;
  for (size_t i = 0; i < reached.size() && before[edge.cur] < 0; ++i) {
    for (const int beside : nodes_[reached[i]].neighbours) {
      if (before[beside] >= 0) continue;
      before[beside] = reached[i];
      reached.push_back(beside);
    }
  }
  if (before[edge.cur] < 0) return false;
  double way = 0.0, turns = 0.0;
  int pairs = 0;
  for (int at = edge.cur; at != edge.ref; at = before[at], ++pairs) {
    const Rigid3d step = pose(at).Inverse() * pose(before[at]);
    way += step.translation.norm();
    turns += step.Angle();
  }
  const double drift = std::max(options_.drift, slack_);
  const double rotation = pairs * std::pow(options_.min_sigma_rotation, 2) +
                          std::pow(drift * turns, 2);
  const double translation =
      pairs * std::pow(options_.min_sigma_translation, 2) +
      std::pow(drift * way, 2) + rotation * way * way / 3.0;
  MotionMatrix covariance = CovarianceOf(edge, slack_);
  covariance.diagonal().head<3>().array() += rotation;
  covariance.diagonal().tail<3>().array() += translation;
  const MotionVector e =
      Difference(edge.cur_from_ref, pose(edge.cur).Inverse() * pose(edge.ref));
  return e.dot(covariance.ldlt().solve(e)) < kLargestSquare;
}

void KeyframeGraph::Join(const Edge& edge) {
  const int from = segment(edge.cur), to = segment(edge.ref);
  const Rigid3d to_from_from =
      pose(edge.ref) * edge.cur_from_ref.Inverse() * pose(edge.cur).Inverse();
  for (Node& node : nodes_) {
    if (node.segment != from) continue;
    node.segment = to;
    node.map_from_cam = to_from_from * node.map_from_cam;
  }
  first_of_.erase(from);
}

bool KeyframeGraph::CanDoWithout(int without) const {
  if (first_of_.at(segment(without)) == without || nodes_[without].is_held) {
    return false;
  }
  const std::vector<int>& around = nodes_[without].neighbours;
  if (around.empty()) return false;
  std::vector<int> reached = {around.front()};
  std::vector<bool> seen(nodes_.size(), false);
  seen[without] = seen[around.front()] = true;
  for (int hops = 0; hops < kHopsAround; ++hops) {
    const size_t end = reached.size();
    for (size_t i = 0; i < end; ++i) {
      for (const int beside : nodes_[reached[i]].neighbours) {
        if (!seen[beside]) reached.push_back(beside);
        seen[beside] = true;
      }
    }
  }
  return std::all_of(around.begin(), around.end(),
                     [&](int at) { return seen[at]; });
}

void KeyframeGraph::Drop(int at, int anchor) {
  Node& node = nodes_[at];
  node.anchor = anchor;
  node.from_anchor.ref = anchor;
  node.from_anchor.cur = at;
  node.from_anchor.cur_from_ref = pose(at).Inverse() * pose(anchor);
  for (const Pair& pair : pairs_) {
    const bool is_it = (pair.edge.ref == at && pair.edge.cur == anchor) ||
                       (pair.edge.ref == anchor && pair.edge.cur == at);
    if (is_it) node.from_anchor.covariance = CovarianceOf(pair.edge, slack_);
  }
  for (const int beside : node.neighbours) {
    std::vector<int>& theirs = nodes_[beside].neighbours;
    theirs.erase(std::remove(theirs.begin(), theirs.end(), at), theirs.end());
  }
  node.neighbours.clear();
  pairs_.erase(std::remove_if(pairs_.begin(), pairs_.end(),
                              [=](const Pair& pair) {
                                return pair.edge.ref == at ||
                                       pair.edge.cur == at;
                              }),
               pairs_.end());
}

Edge KeyframeGraph::Anchored(Edge edge) const {
  while (IsDropped(edge.ref)) {
    const Edge& step = nodes_[edge.ref].from_anchor;
    edge.covariance = ComposedCovariance(edge.cur_from_ref, edge.covariance,
                                         step.cur_from_ref, step.covariance);
    edge.cur_from_ref = edge.cur_from_ref * step.cur_from_ref;
    edge.ref = step.ref;
  }
  return edge;
}

bool KeyframeGraph::IsFixed(int at) const {
  return nodes_[at].is_held || first_of_.at(segment(at)) == at;
}

// What the noise models say, a floor, and what a camera that is not quite as
// its calibration says makes of a motion: an error in proportion to it.
MotionMatrix KeyframeGraph::CovarianceOf(const Edge& edge, double slack) const {
  MotionMatrix covariance = edge.covariance;
  const double angle = edge.cur_from_ref.Angle();
  const double way =
      edge.cur_from_ref.translation.norm() + kTypicalDepth * angle;
  covariance.diagonal().head<3>().array() +=
      std::pow(options_.min_sigma_rotation, 2) + std::pow(slack * angle, 2);
  covariance.diagonal().tail<3>().array() +=
      std::pow(options_.min_sigma_translation, 2) + std::pow(slack * way, 2);
  return covariance;
}

MotionMatrix KeyframeGraph::CovarianceAsSolved(const Pair& pair) const {
  const MotionMatrix covariance = CovarianceOf(pair.edge, slack_);
  const MotionVector e =
      Difference(pose(pair.edge.cur).Inverse() * pose(pair.edge.ref),
                 pair.edge.cur_from_ref);
  double rho[3];
  (pair.is_tracked ? tracked_loss_ : pair_loss_)
      ->Evaluate(e.dot(covariance.ldlt().solve(e)), rho);
  return covariance / std::max(rho[1], 1e-9);
}

// The slack with which half of the pairs agree with the poses as well as their
// covariances say.
double KeyframeGraph::FindSlack() const {
  const auto median = [&](double slack) {
    std::vector<double> squares;
    for (const Pair& pair : pairs_) {
      if (pair.is_tracked) continue;
      const MotionVector e =
          Difference(pose(pair.edge.cur).Inverse() * pose(pair.edge.ref),
                     pair.edge.cur_from_ref);
      squares.push_back(e.dot(CovarianceOf(pair.edge, slack).ldlt().solve(e)));
    }
    return Median(squares);
  };
  const auto pairs = std::count_if(pairs_.begin(), pairs_.end(),
                                   [](const auto& p) { return !p.is_tracked; });
  if (pairs < kMinPairsForSlack || median(0.0) <= kMedianSquare) return 0.0;
  double low = 0.0, high = kMaxSlack;
  for (int step = 0; step < 12; ++step) {
    const double middle = 0.5 * (low + high);
    (median(middle) > kMedianSquare ? low : high) = middle;
  }
  return high;
}

// A graph, and which of its poses are keyframes.
struct KeyframeGraph::Problem {
  MotionGraph graph;
  std::vector<int> pose_of;  // of each keyframe; -1: none
};

KeyframeGraph::Problem KeyframeGraph::Build(const std::vector<int>& free,
                                            bool graduated) const {
  MotionGraphOptions options;
  options.graduated = graduated;
  options.max_rounds = 3;
  options.settled_within = 1e-5;
  Problem problem{MotionGraph(options), std::vector<int>(nodes_.size(), -1)};
  const auto add = [&](int at, bool is_fixed) {
    if (problem.pose_of[at] < 0) {
      problem.pose_of[at] = problem.graph.AddPose(pose(at), is_fixed);
    }
  };
  std::vector<bool> is_free(nodes_.size(), false);
  for (const int at : free) {
    is_free[at] = !IsFixed(at);
    add(at, IsFixed(at));
  }
  for (const Pair& pair : pairs_) {
    Edge edge = pair.edge;
    if (!is_free[edge.ref] && !is_free[edge.cur]) continue;
    add(edge.ref, true);
    add(edge.cur, true);
    edge.covariance = CovarianceOf(edge, slack_);
    edge.ref = problem.pose_of[edge.ref];
    edge.cur = problem.pose_of[edge.cur];
    problem.graph.AddEdge(
        edge, pair.is_tracked ? tracked_loss_.get() : pair_loss_.get());
  }
  return problem;
}

std::string KeyframeGraph::Solve(const std::vector<int>& free, bool graduated) {
  Problem problem = Build(free, graduated);
  const GraphSolution solution = problem.graph.Solve();
  if (!solution.ok()) return solution.reason;
  for (const int at : free) {
    nodes_[at].map_from_cam = problem.graph.pose(problem.pose_of[at]);
  }
  FollowAnchors();
  return "";
}

void KeyframeGraph::FollowAnchors() {
  // An anchor may have been dropped later, but it is older.
  for (Node& node : nodes_) {
    if (node.anchor < 0) continue;
    node.map_from_cam =
        pose(node.anchor) * node.from_anchor.cur_from_ref.Inverse();
    node.segment = segment(node.anchor);
  }
}

std::string KeyframeGraph::SolveNear(int newest) {
  std::vector<int> free;
  int latest = 0;
  for (int at = newest; at >= 0 && latest < options_.window; --at) {
    if (IsDropped(at)) continue;
    free.push_back(at);
    ++latest;
  }
  for (const int at : neighbours(newest)) {
    if (at < free.back()) free.push_back(at);
  }
  return Solve(free, /*graduated=*/false);
}

std::vector<int> KeyframeGraph::All() const {
  std::vector<int> all;
  for (int at = 0; at < size(); ++at) {
    if (!IsDropped(at)) all.push_back(at);
  }
  return all;
}

std::string KeyframeGraph::SolveAll(bool graduated) {
  std::string trouble;
  for (int round = 0; round < kMaxSlackRounds; ++round) {
    trouble = Solve(All(), graduated);
    const double slack = FindSlack();
    const bool is_settled = std::abs(slack - slack_) <= 0.1 * slack_;
    slack_ = slack;
    if (!trouble.empty() || is_settled) break;
  }
  return trouble;
}

std::vector<MotionMatrix> KeyframeGraph::Covariances() const {
  const Problem problem = Build(All(), /*graduated=*/false);
  std::vector<int> poses;
  for (const int at : All()) poses.push_back(problem.pose_of[at]);
  std::vector<MotionMatrix> all(nodes_.size(), MotionMatrix::Zero());
  const std::vector<MotionMatrix> found = problem.graph.Covariances(poses);
  if (found.empty()) return {};
  size_t next = 0;
  for (const int at : All()) {
    all[at] = problem.graph.Redundancy() * found[next++];
  }
  return all;
}

}  // namespace rgbd_pose
