#include "core/evaluation/alignment.h"

#include <Eigen/Geometry>

#include "core/geometry/closed_form.h"

namespace rgbd_pose {
namespace {

// How much the orientation of the first pair counts against the spread of the
// positions: enough to outweigh their rounding errors, too little to change a
// rotation that they determine by more than about 1e-9 rad.
constexpr double kShareOfSpread = 1e-9;
constexpr double kLeastSpread = 1e-18;  // m^2 a pair: a spread of 1 nm

}  // namespace

Rigid3d AlignRigidly(const std::vector<PosePair>& pairs) {
  PairMoments moments;
  for (const PosePair& pair : pairs) {
    moments.Add(pair.truth.translation, pair.estimate.translation);
  }
  const Eigen::Quaterniond first =
      pairs[0].truth.rotation * pairs[0].estimate.rotation.conjugate();
  const double weight =
      kShareOfSpread * moments.spread + kLeastSpread * moments.count;
  const Eigen::Quaterniond rotation(
      NearestRotation(moments.covariance + weight * first.toRotationMatrix())
          .rotation);
  return Rigid3d(rotation,
                 moments.target_mean - rotation * moments.source_mean);
}

}  // namespace rgbd_pose
