#pragma once

#include <string>

#include "core/pose_graph/graph_blocks.h"
#include "core/pose_graph/graph_problem.h"

// Why the graph cannot be solved, as one line; empty: it can.
// Poses are named by the numbers that users know them by.

namespace rgbd_pose {

// Numbers that are not finite, and edges that are not between two poses.
std::string FindBadInput(const GraphTerms& graph);

// A pose that nothing joins to a fixed one or to the world.
std::string FindUnanchoredPose(const GraphTerms& graph);

// A pose of which some direction has a larger standard deviation (rad or m),
// all others held where they are or known no better.
std::string FindUndetermined(const GraphTerms& graph,
                             double max_standard_deviation,
                             GraphProblem* problem);

}  // namespace rgbd_pose
