#pragma once

#include <ceres/loss_function.h>

#include <string>
#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"

namespace rgbd_pose {

// What a PoseGraph holds, as its parts see it: poses, by their numbers, and
// what is known of them.
struct GraphTerms {
  // A pose and whether it is held.
  struct Pose {
    Rigid3d world_from_cam;  // as it is estimated now
    bool is_fixed = false;   // it stays where it is
  };
  // A motion that was measured.
  struct Edge {
    int ref = 0;                                // the pose it is seen from
    int cur = 0;                                // the pose it leads to
    Rigid3d cur_from_ref;                       // as it was measured
    MotionMatrix root;                          // see SqrtInformation
    const ceres::LossFunction* loss = nullptr;  // null: squares
  };
  std::vector<Pose> poses;  // by their numbers
  std::vector<Edge> edges;  // in the order they were added

  // cur_from_ref as the poses have it.
  Rigid3d Between(int ref, int cur) const {
    return poses[cur].world_from_cam.Inverse() * poses[ref].world_from_cam;
  }

  // Whether there is such a pose.
  bool Has(int pose) const {
    return pose >= 0 && pose < static_cast<int>(poses.size());
  }

  // Whether what is between the two changes nothing.
  bool IsIdle(int ref, int cur) const {
    return poses[ref].is_fixed && poses[cur].is_fixed;
  }
};

// How a graph is solved.
struct PoseGraphOptions {
  // Losses on edges are so wide at first that all edges count, then narrower
  // step by step: for poses that may be far off. Else at once.
  bool graduated = false;

  // At most so often poses become the origins of another solve.
  int max_rounds = 10;

  // Where no pose moves by more (rad and m), nothing further is gained.
  double step_tolerance = 1e-6;

  // Of the solver in each round.
  int max_iterations = 30;

  // A pose is not determined if, all others held where they are or known no
  // better, some direction of it has a larger standard deviation (rad or m).
  double max_standard_deviation = 0.5;

  // Of the solver. The result is the same for one number, not for all.
  int threads = 1;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// How far a solved graph can be believed.
enum class GraphStatus {
  kOk,
  kBadInput,      // a pose or edge is invalid
  kNotAnchored,   // some poses hang on nothing that is fixed
  kSingular,      // some pose is not determined
  kNotConverged,  // the solver gave up; the poses are those before
};

// As programs print it.
inline const char* ToString(GraphStatus status) {
  constexpr const char* kNames[] = {"ok", "bad_input", "not_anchored",
                                    "singular", "not_converged"};
  return kNames[static_cast<int>(status)];
}

// What came of a solve.
struct GraphSolution {
  // Whether the poses may be used.
  GraphStatus status = GraphStatus::kOk;
  std::string reason;  // in words; empty if ok

  double initial_cost = 0.0;  // with the losses at their own widths
  double final_cost = 0.0;    // likewise, at the new poses
  int iterations = 0;         // of the solver, all rounds together
  int rounds = 0;             // see PoseGraphOptions::max_rounds

  // Whether the poses are those that agree best.
  bool ok() const { return status == GraphStatus::kOk; }
};

// Poses that are moved together until they agree best with the motions measured
// between them, edges with their covariances: a Ceres problem without
// landmarks. Each edge under a loss or, null, none. Bad data is a status of
// Solve, never an abort.
class PoseGraph {
 public:
  // Throws InputError for options that are not sound (see Check).
  explicit PoseGraph(const PoseGraphOptions& options = {});

  // Returns its number: 0, 1, 2, ... A fixed pose stays where it is.
  int AddPose(const Rigid3d& world_from_cam, bool is_fixed = false) {
    graph_.poses.push_back({world_from_cam, is_fixed});
    return num_poses() - 1;
  }

  // `edge.ref` and `edge.cur` are numbers of poses. The loss must outlive the
  // graph and sees the whole edge: 6 whitened rows.
  int AddEdge(const RelativePose& edge,
              const ceres::LossFunction* loss = nullptr);

  // Where the next Solve begins, or stays if it is fixed.
  void SetPose(int pose, const Rigid3d& world_from_cam) {
    graph_.poses[pose].world_from_cam = world_from_cam;
  }
  // Whether it is, from now on.
  void SetFixed(int pose, bool is_fixed) {
    graph_.poses[pose].is_fixed = is_fixed;
  }

  // Moves the poses that are not fixed. What lies between fixed poses alone is
  // left out.
  GraphSolution Solve();

  // How many there are.
  int num_poses() const { return static_cast<int>(graph_.poses.size()); }
  // world_from_cam.
  const Rigid3d& pose(int pose) const {
    return graph_.poses[pose].world_from_cam;
  }

  // Covariances of poses, [omega (rad), C (m)] with omega about the axes of the
  // camera and C its centre in the world, after a Solve that was ok; zero for
  // fixed poses. They count each edge as independent of others: see
  // OvercountingFactor. Empty where they cannot be computed.
  std::vector<MotionMatrix> MarginalCovariances(
      const std::vector<int>& poses) const;

  // Overcounting of the information: the number of edges by the number of
  // motions that poses have (a tree: 1). Edges between frames that see the same
  // features share those features' noise, so that k frames matched each with
  // each know no more than k - 1 edges do, though they have k (k - 1) / 2:
  // their covariances are too small by this factor. An upper bound: for edges
  // that are independent (wheels, other features) it is 1.
  double OvercountingFactor() const;

 private:
  // One round at a width of the losses; by how much a pose moved at most (rad
  // and m), or NaN if the solver gave up.
  double Round(double width, int max_iterations, GraphSolution* solution);

  PoseGraphOptions options_;
  GraphTerms graph_;
};

}  // namespace rgbd_pose
