#pragma once

#include <ceres/loss_function.h>

#include <string>
#include <vector>

#include "core/factors/common_direction.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The content of a PoseGraph: poses and what was measured between them.
struct GraphTerms {
  // A node of the graph.
  struct Pose {
    Rigid3d world_from_cam;  // current estimate
    bool is_fixed = false;   // stays where it is
  };
  // A measured motion.
  struct Edge : RelativePose {
    MotionMatrix root;                          // see SqrtInformation
    const ceres::LossFunction* loss = nullptr;  // null: least squares
  };
  // A direction measured in the axes of two poses.
  struct Direction {
    int a = 0;                                  // number of the first pose
    int b = 0;                                  // number of the second pose
    CommonDirectionFactor factor;               // with what was measured
    const ceres::LossFunction* loss = nullptr;  // null: least squares
  };
  std::vector<Pose> poses;            // index = number
  std::vector<Edge> edges;            // in the order of addition
  std::vector<Direction> directions;  // in the order of addition

  // Whether a measurement between the two poses has no effect.
  bool IsIdle(int ref, int cur) const {
    return poses[ref].is_fixed && poses[cur].is_fixed;
  }
};

// How a graph is solved.
struct PoseGraphOptions {
  // Solves a second time, with losses so wide at first that all edges count and
  // narrowed step by step: for poses that may be far off. This result is kept
  // if its final cost is lower by more than one edge may differ by chance;
  // without that, or without a solution, that of the final widths at once.
  // Where wrong edges agree with each other as well as the right ones, neither
  // can tell.
  bool graduated = false;

  // Maximum number of solves, each from the poses of the last one. One more
  // than the poses need to arrive, which shows that they have.
  int max_rounds = 10;

  // Poses have arrived if a solve moves none by more than this (rad and m).
  double step_tolerance = 1e-6;

  // A motion between two poses is determined if no direction of it has a larger
  // standard deviation (rad or m), all edges taken together; a pose if a path
  // of edges with such motions leads from it to a fixed one. Along a path
  // errors add up: for how far a pose may be from the fixed ones, see
  // MarginalCovariances.
  double max_standard_deviation = 0.5;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Whether the result of a solve can be trusted.
enum class GraphStatus {
  kOk,
  kBadInput,      // a pose or edge is invalid
  kNotAnchored,   // some poses are not connected to a fixed pose
  kSingular,      // some pose is not determined
  kNotConverged,  // poses still moved in the end; they are unchanged
};

// The name printed by programs.
inline const char* ToString(GraphStatus status) {
  constexpr const char* kNames[] = {"ok", "bad_input", "not_anchored",
                                    "singular", "not_converged"};
  return kNames[static_cast<int>(status)];
}

// The result of a solve.
struct GraphSolution {
  GraphStatus status = GraphStatus::kOk;  // outcome, with its reason:
  std::string reason;                     // in words; empty if ok

  double initial_cost = 0.0;  // with the final widths of the losses
  double final_cost = 0.0;    // the same at the poses after solving
  int iterations = 0;         // how often the graph was linearised

  // Whether the poses are the ones that agree best with the edges.
  bool ok() const { return status == GraphStatus::kOk; }
};

// Poses that are optimised together until they agree best with the motions
// and directions measured between them. Invalid data gives a status of Solve,
// never an abort.
class PoseGraph {
 public:
  // Throws InputError for invalid options (see Check).
  explicit PoseGraph(const PoseGraphOptions& options = {});

  // Returns the number of the pose: 0, 1, 2, ... A fixed pose is not moved.
  int AddPose(const Rigid3d& world_from_cam, bool is_fixed = false) {
    graph_.poses.push_back({world_from_cam, is_fixed});
    return num_poses() - 1;
  }

  // `edge.ref` and `edge.cur` are numbers of poses. The loss (null: least
  // squares) must outlive the graph and applies to all 6 whitened rows.
  void AddEdge(const RelativePose& edge,
               const ceres::LossFunction* loss = nullptr);

  // Adds a direction measured in the axes of two poses, such as gravity in a
  // camera and in an upright frame. It connects nothing: both poses need edges.
  // The loss is as for edges.
  void AddDirection(int a, int b, const CommonDirectionFactor& factor,
                    const ceres::LossFunction* loss = nullptr) {
    graph_.directions.push_back({a, b, factor, loss});
  }

  // Optimises the poses that are not fixed. Starts where they are or, if that
  // costs less, where the shortest paths of edges without a loss put them.
  // Ignores edges between fixed poses.
  GraphSolution Solve();

  // The number of poses, fixed ones included.
  int num_poses() const { return static_cast<int>(graph_.poses.size()); }
  // Returns world_from_cam.
  const Rigid3d& pose(int pose) const {
    return graph_.poses[pose].world_from_cam;
  }

  // Covariances of [omega (rad), C (m)], omega about the axes of the camera, C
  // in the world, after a successful Solve; zero for fixed poses. All edges
  // count as independent: see OvercountingFactor. Empty if not computable.
  // Throws InputError for a pose that does not exist.
  std::vector<MotionMatrix> MarginalCovariances(
      const std::vector<int>& poses) const;

  // How often information is counted, at most: the number of edges divided by
  // that of poses that are not fixed (1 for a tree). Edges between frames that
  // see the same features share noise: all k (k - 1) / 2 edges between k frames
  // contain no more information than k - 1. Independent edges count only once.
  double OvercountingFactor() const;

 private:
  PoseGraphOptions options_;
  GraphTerms graph_;
};

}  // namespace rgbd_pose
