#include "core/pose_graph/graph_terms.h"

#include "core/pose_graph/graph_blocks.h"

namespace rgbd_pose {

double GraphTerms::SquaredMahalanobisDistance(const Edge& edge) const {
  const Rigid3d motion = Between(edge.ref, edge.cur);
  RelativeMotion pair;
  pair.motion = {motion.rotation.toRotationMatrix(),
                 motion.Inverse().translation};
  return RelativePoseErrorTerm::Of(edge.cur_from_ref, edge.root)
      .ResidualAt(pair, nullptr)
      .squaredNorm();
}

}  // namespace rgbd_pose
