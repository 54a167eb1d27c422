#include "core/util/small_matrix.h"

namespace rgbd_pose {

Eigen::SelfAdjointEigenSolver<SmallMatrix> EigenOf(const SmallMatrix& matrix) {
  return Eigen::SelfAdjointEigenSolver<SmallMatrix>(matrix);
}

}  // namespace rgbd_pose
