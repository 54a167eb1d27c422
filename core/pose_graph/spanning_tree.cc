#include "core/pose_graph/spanning_tree.h"

#include <algorithm>

namespace rgbd_pose {

std::vector<TreeNode> SpanningTree(const GraphTerms& graph,
                                   const std::vector<bool>& is_usable) {
  std::vector<std::vector<int>> edges_of(graph.poses.size());
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    if (!is_usable[i]) continue;
    edges_of[graph.edges[i].ref].push_back(static_cast<int>(i));
    edges_of[graph.edges[i].cur].push_back(static_cast<int>(i));
  }
  std::vector<TreeNode> tree;
  std::vector<bool> is_reached(graph.poses.size(), false);
  const auto reach = [&](int pose, int edge) {
    if (is_reached[pose]) return;
    is_reached[pose] = true;
    tree.push_back({pose, edge});
  };
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    if (graph.poses[i].is_fixed) reach(static_cast<int>(i), -1);
  }
  for (size_t next = 0; next < tree.size(); ++next) {
    for (const int edge : edges_of[tree[next].pose]) {
      reach(graph.edges[edge].ref, edge);
      reach(graph.edges[edge].cur, edge);
    }
  }
  return tree;
}

int FirstOutside(const std::vector<TreeNode>& tree, const GraphTerms& graph) {
  std::vector<bool> is_inside(graph.poses.size(), false);
  for (const TreeNode& node : tree) is_inside[node.pose] = true;
  const auto first = std::find(is_inside.begin(), is_inside.end(), false);
  return first == is_inside.end() ? -1
                                  : static_cast<int>(first - is_inside.begin());
}

std::vector<GraphTerms::Pose> PosesByTree(const std::vector<TreeNode>& tree,
                                          const GraphTerms& graph) {
  std::vector<GraphTerms::Pose> poses = graph.poses;
  for (const TreeNode& node : tree) {
    if (node.edge < 0) continue;
    const GraphTerms::Edge& edge = graph.edges[node.edge];
    poses[node.pose].world_from_cam =
        node.pose == edge.cur
            ? poses[edge.ref].world_from_cam * edge.cur_from_ref.Inverse()
            : poses[edge.cur].world_from_cam * edge.cur_from_ref;
  }
  return poses;
}

}  // namespace rgbd_pose
