#include "core/factors/sampler.h"

#include <Eigen/Geometry>

namespace rgbd_pose {

Rigid3d FactorSampler::Motion() {
  Eigen::Vector4d q;
  do {
    q = Vector<4>(1.0);
  } while (q.squaredNorm() > 1.0 || q.squaredNorm() < 0.01);
  return Rigid3d(Eigen::Quaterniond(q), Vector<3>(2.0));
}

}  // namespace rgbd_pose
