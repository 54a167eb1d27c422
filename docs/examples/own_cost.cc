// A cost of your own: the 3D error of a match in percent of its depth.
#include <cstdio>

#include "rgbd_pose/core/estimation/estimator.h"
#include "rgbd_pose/costs/assembly/cost_of.h"
#include "rgbd_pose/costs/parts/forward_error.h"
#include "rgbd_pose/frontend/settings/settings.h"
#include "rgbd_pose/frontend/simulation/synthetic_dataset.h"
#include "rgbd_pose/frontend/simulation/synthetic_matches.h"

struct RelativeError : rgbd_pose::ForwardError {  // kColumns and Pack of that
  static constexpr char kName[] = "relative_error";
  static constexpr int kRows = 3, kDegreesOfFreedom = 3;
  static constexpr bool kIsWhitened = false;
  template <typename M, typename D, typename T>
  static void Residual(const rgbd_pose::RotationAndCenter<M>& motion,
                       const D* columns, T* r) {
    Error(motion, columns, r);
    for (int i = 0; i < 3; ++i) r[i] = 100.0 * r[i] / columns[5];
  }
};

rgbd_pose::Estimator MakeOwn() {
  return rgbd_pose::Estimator({}, rgbd_pose::MakeCost<RelativeError>(),
                              std::make_unique<ceres::CauchyLoss>(2.0));
}

int main() {
  rgbd_pose::RandomWorld world(1);  // stands for your matches
  const rgbd_pose::Rigid3d truth = world.Motion(0.1, 0.1);
  const auto estimate = MakeOwn().Estimate(world.Matches(500, 0.2, truth));
  const auto error = estimate.cur_from_prev.Inverse() * truth;
  std::printf("error %.2f mm\n", 1e3 * error.translation.norm());

  const rgbd_pose::SyntheticDataset room({"room", "pan_tilt", 60});  // or yours
  rgbd_pose::Odometry odometry =
      rgbd_pose::MakeOdometry({}, room.camera(), MakeOwn());
  for (int i = 0; i < room.size(); ++i) odometry.Track(room.Read(i));
  std::printf("back at the start within %.2f mm\n",
              1e3 * odometry.WorldFromCam().translation.norm());
  return estimate.ok() ? 0 : 1;
}
