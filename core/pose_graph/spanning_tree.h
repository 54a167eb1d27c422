#pragma once

#include <vector>

#include "core/pose_graph/pose_graph.h"

namespace rgbd_pose {

// A pose that edges connect to a fixed one.
struct TreeNode {
  int pose;  // its number
  int edge;  // by which it was reached; -1 for a fixed pose
};

// The poses that are fixed, or connected to a fixed pose by edges with
// `is_usable` (one entry per edge): those nearest to it, in edges, first.
std::vector<TreeNode> SpanningTree(const GraphTerms& graph,
                                   const std::vector<bool>& is_usable);

// The first pose that is not in the tree; -1 if all are.
int FirstOutside(const std::vector<TreeNode>& tree, const GraphTerms& graph);

// The poses of the graph as the edges of a tree of all poses measure them. Few
// edges lead to each, so that these poses drift less than those of a long path.
std::vector<GraphTerms::Pose> PosesByTree(const std::vector<TreeNode>& tree,
                                          const GraphTerms& graph);

}  // namespace rgbd_pose
