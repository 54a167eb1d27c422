// A loss of your own: least squares up to its width, no influence beyond.
#include <cstdio>

#include "rgbd_pose/core/estimation/estimator.h"
#include "rgbd_pose/costs/cost_factory.h"
#include "rgbd_pose/frontend/simulation/synthetic_matches.h"

class TruncatedLoss final : public ceres::LossFunction {
 public:
  explicit TruncatedLoss(double width) : width2_(width * width) {}
  void Evaluate(double s, double rho[3]) const override {  // s = |r|^2
    rho[0] = s < width2_ ? s : width2_;
    rho[1] = s < width2_ ? 1.0 : 0.0;
    rho[2] = 0.0;
  }

 private:
  const double width2_;  // in squared sigmas
};

int main() {
  rgbd_pose::RandomWorld world(1);  // stands for your matches
  const rgbd_pose::Rigid3d truth = world.Motion(0.1, 0.1);
  rgbd_pose::Estimator estimator({}, rgbd_pose::MakeCost("bidirectional_point"),
                                 std::make_unique<TruncatedLoss>(4.0));
  const auto estimate = estimator.Estimate(world.Matches(500, 0.4, truth));
  const auto error = estimate.cur_from_prev.Inverse() * truth;
  std::printf("error %.2f mm\n", 1e3 * error.translation.norm());
  return estimate.ok() ? 0 : 1;
}
