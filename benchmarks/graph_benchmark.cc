// A graph of keyframes, solved by edges and by a bundle adjustment of
// landmarks: time and remaining error.
//
// Names: graph/<way>/<keyframes>.

#include <benchmark/benchmark.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/bundle_adjustment.h"
#include "benchmarks/simulated_graph.h"
#include "core/pose_graph/pose_graph.h"
#include "frontend/slam/keyframe_graph.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

constexpr int kWorlds = 5;                // number of worlds for the errors
constexpr double kWrongFocal = 1.02;      // focal factor of a wrong camera
constexpr int kMostWithWrongFocal = 100;  // keyframes

struct World {
  World(int keyframes, unsigned seed, double focal_factor)
      : graph(keyframes, seed, focal_factor),
        edges(graph.Edges()),
        start(OdometryOf(graph, edges)) {}

  const SimulatedGraph graph;
  const std::vector<RelativePose> edges;
  const std::vector<Rigid3d> start;
};

// The world for timing, made once.
const World& TimedWorld(int keyframes) {
  static std::map<int, World> made;
  return made.try_emplace(keyframes, keyframes, 1, 1.0).first->second;
}

struct Solved {
  std::vector<Rigid3d> poses;
  int iterations = 0;
};

using Way = std::function<Solved(const World&)>;

Solved Solve(PoseGraph* graph) {
  const GraphSolution solution = graph->Solve();
  Solved solved;
  if (!solution.ok()) return solved;
  solved.iterations = solution.iterations;
  for (int i = 0; i < graph->num_poses(); ++i) {
    solved.poses.push_back(graph->pose(i));
  }
  return solved;
}

Solved ByEdges(const World& world) {
  PoseGraph graph;
  for (size_t i = 0; i < world.start.size(); ++i) {
    graph.AddPose(world.start[i], i == 0);
  }
  for (const RelativePose& edge : world.edges) graph.AddEdge(edge);
  return Solve(&graph);
}

Solved ByBundle(const World& world) {
  const auto loss = ParseLoss("huber").Make(3);
  BundleSolution solution = AdjustBundle(world.graph, world.start, loss.get());
  return {std::move(solution.poses), solution.iterations};
}

// With the losses, noise and stages of a map.
std::unique_ptr<KeyframeGraph> KeyframeGraphOf(const World& world) {
  auto graph = std::make_unique<KeyframeGraph>(10, 0.01);
  for (const Rigid3d& pose : world.start) graph->Add(pose, 0);
  for (const RelativePose& edge : world.edges) {
    graph->AddPair(edge, edge.cur == edge.ref + 1);
  }
  return graph;
}

Solved ByMap(const World& world) {
  const auto graph = KeyframeGraphOf(world);
  Solved solved;
  if (!graph->SolveAll().empty()) return solved;
  for (int i = 0; i < graph->size(); ++i) {
    solved.poses.push_back(graph->pose(i));
  }
  return solved;
}

// Odometry alone, the initial guess of all other ways.
Solved ByOdometry(const World& world) { return {world.start, 0}; }

// Root mean square over worlds, mm; NaN if a solve failed.
double MeanError(const Way& way, int keyframes, double focal_factor) {
  double sum = 0.0;
  for (int seed = 1; seed <= kWorlds; ++seed) {
    const World world(keyframes, seed, focal_factor);
    const Solved solved = way(world);
    if (solved.poses.empty()) return std::nan("");
    sum += std::pow(RmsError(solved.poses, world.graph.truth), 2);
  }
  return 1e3 * std::sqrt(sum / kWorlds);
}

void Run(benchmark::State& state, const std::string& name, const Way& way,
         int keyframes) {
  const World& world = TimedWorld(keyframes);
  Solved solved;
  for (auto _ : state) solved = way(world);
  if (solved.poses.empty()) return state.SkipWithError("was not solved");
  // Stored, because each benchmark runs several times.
  static std::map<std::string, std::pair<double, double>> errors;
  const auto [error, is_new] = errors.try_emplace(name);
  if (is_new) {
    error->second.first = MeanError(way, keyframes, 1.0);
    error->second.second = keyframes > kMostWithWrongFocal
                               ? std::nan("")
                               : MeanError(way, keyframes, kWrongFocal);
  }
  state.counters["pairs"] = static_cast<double>(world.edges.size());
  if (solved.iterations > 0) state.counters["steps"] = solved.iterations;
  state.counters["error_mm"] = error->second.first;
  if (!std::isnan(error->second.second)) {
    state.counters["wrong_focal_mm"] = error->second.second;
  }
}

// The motions of the pairs; all ways but bundle adjustment need them once.
void EstimatePairs(benchmark::State& state, int keyframes) {
  const World& world = TimedWorld(keyframes);
  for (auto _ : state) benchmark::DoNotOptimize(world.graph.Edges());
  state.counters["pairs"] = static_cast<double>(world.edges.size());
}

// The solve of a map at each new keyframe.
void SolveWindow(benchmark::State& state, int keyframes) {
  const World& world = TimedWorld(keyframes);
  const auto graph = KeyframeGraphOf(world);
  graph->SolveAll();
  for (auto _ : state) {
    if (!graph->SolveNear(keyframes - 1).empty()) {
      state.SkipWithError("was not solved");
    }
  }
  state.counters["pairs"] = static_cast<double>(world.edges.size());
}

const bool kRegistered = [] {
  const std::pair<const char*, Way> ways[] = {{"odometry", ByOdometry},
                                              {"edges", ByEdges},
                                              {"bundle_adjustment", ByBundle},
                                              {"map", ByMap}};
  const auto name = [](const char* what, int keyframes) {
    return std::string("graph/") + what + "/" + std::to_string(keyframes);
  };
  const auto add = [](const std::string& full, auto run) {
    benchmark::RegisterBenchmark(full.c_str(), run)
        ->Unit(benchmark::kMillisecond);
  };
  for (const int keyframes : {100, 1000}) {
    for (const auto& [what, way] : ways) {
      const std::string full = name(what, keyframes);
      add(full, [=, way = way](benchmark::State& state) {
        Run(state, full, way, keyframes);
      });
    }
    for (const auto& [what, run] :
         {std::pair("pairs", &EstimatePairs), {"map_window", &SolveWindow}}) {
      add(name(what, keyframes),
          [=, run = run](benchmark::State& state) { run(state, keyframes); });
    }
  }
  return true;
}();

}  // namespace
}  // namespace rgbd_pose
