#include "frontend/tracking/velocity_prior.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

// Changes of velocity from frame to frame (root mean squares) of a tripod are taken to be as large as that.
constexpr double kMinChangeAngular = 0.01;
constexpr double kMinChangeLinear = 0.005;

// How fast the mean squares forget: some ten frames.
constexpr double kShareOfNew = 0.1;

}  // namespace

Twist VelocityPrior::Between(const Rigid3d& cur_from_ref,
                             const Twist& twist) const {
  const Rigid3d cur_from_prev = twist.MotionDuring(middle) * cur_from_ref *
                                prev_from_ref.Inverse() *
                                prev_middle_from_prev.Inverse();
  return TwistOf(cur_from_prev, interval);
}

// Of an acceleration that is white noise the velocity at the end of an interval
// has the mean 3/2 of the mean velocity in it less 1/2 of that at its start,
// and a quarter of the variance that it has if the motion is not known.
Twist VelocityPrior::Mean(const Rigid3d& cur_from_ref,
                          const Twist& twist) const {
  const Twist between = Between(cur_from_ref, twist);
  if (!prev_twist.has_value()) return between;
  return 1.5 * between - 0.5 * *prev_twist;
}

VelocityPrior VelocityModel::Prior(const Rigid3d& prev_from_ref,
                                   double interval, double middle) const {
  VelocityPrior prior;
  prior.prev_from_ref = prev_from_ref;
  prior.prev_twist = last_;
  prior.interval = interval;
  prior.middle = middle;
  prior.prev_middle_from_prev = middle_from_last_;
  prior.sigma_angular =
      0.5 * std::max(kMinChangeAngular, std::sqrt(change_angular_));
  prior.sigma_linear =
      0.5 * std::max(kMinChangeLinear, std::sqrt(change_linear_));
  return prior;
}

void VelocityModel::Add(const Twist& twist, double middle) {
  if (last_.has_value()) {
    const Twist change = twist - *last_;
    change_angular_ += kShareOfNew * (change.angular.squaredNorm() / 3.0 -
                                      change_angular_);
    change_linear_ +=
        kShareOfNew * (change.linear.squaredNorm() / 3.0 - change_linear_);
  }
  last_ = twist;
  middle_from_last_ = twist.MotionDuring(middle);
}

}  // namespace rgbd_pose
