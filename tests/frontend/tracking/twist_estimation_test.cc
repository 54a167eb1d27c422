#include "frontend/tracking/twist_estimation.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/estimation/estimator.h"
#include "costs/cost_factory.h"
#include "frontend/frame/observe.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

const Twist kTwist = {{0.8, -0.5, 0.6}, {-0.3, 0.5, 0.4}};

// Shutters of colour and depth of a handheld sensor.
FrameTiming TimingOf(const Twist& twist) {
  return {{-0.0075, 0.028}, {-0.018, 0.028}, twist};
}

// Matches with a rolling-shutter frame, which can be moved by any velocity.
// Each is on a surface of its own, steep or not.
class RollingMatches {
 public:
  // `timing`: the true one.
  RollingMatches(const FrameTiming& timing, const Rigid3d& cur_from_ref,
                 double noise, unsigned seed)
      : timing_(timing) {
    RandomWorld world(seed);
    for (int i = 0; i < 300; ++i) {
      Measured m;
      world.Match(camera_, cur_from_ref, &m.match.prev, &m.match.cur);
      Observation& cur = m.match.cur;
      const Eigen::Vector3d point = camera_.Ray(cur.u, cur.v) * cur.depth;
      Eigen::Vector3d normal = world.Vector(0.8);
      normal.z() = -1.0;
      normal.normalize();
      const Eigen::Vector2d seen = ImagePoint(camera_, timing, point);
      m.taken = timing.depth.RowTime(seen.y(), camera_.height);
      // The surface at the time of the depth exposure.
      const Rigid3d moved = timing.twist.MotionDuring(m.taken);
      m.normal = moved.rotation * normal;
      const Eigen::Vector3d then = timing.twist.MovedPoint(point, m.taken);
      m.distance = m.normal.dot(
          then * (1.0 + world.Normal(noise) * cur.sigma_depth / then.z()));
      cur.u = seen.x() + world.Normal(noise * cur.sigma_px);
      cur.v = seen.y() + world.Normal(noise * cur.sigma_px);
      Observation& prev = m.match.prev;
      prev.u += world.Normal(noise * prev.sigma_px);
      prev.v += world.Normal(noise * prev.sigma_px);
      prev.depth += world.Normal(noise * prev.sigma_depth);
      measured_.push_back(m);
    }
  }

  // Every tenth match becomes an outlier.
  void AddOutliers() {
    RandomWorld world(7);
    for (size_t i = 0; i < measured_.size(); i += 10) {
      measured_[i].match.cur.u += world.Uniform(20.0, 60.0);
      measured_[i].match.cur.v -= world.Uniform(20.0, 60.0);
    }
  }

  // The matches as computed by Observe().
  Correspondences MovedBy(const Twist& twist) const {
    Correspondences moved(camera_);
    for (const Measured& m : measured_) {
      Observation cur = m.match.cur;
      const Eigen::Vector3d ray = camera_.Ray(cur.u, cur.v);
      const double seen = timing_.color.RowTime(cur.v, camera_.height);
      // Distance to the surface along the ray; points move in proportion to z.
      const auto behind = [&](double z) {
        const Eigen::Vector3d at_stamp = twist.MovedPoint(ray * z, -seen);
        return m.normal.dot(twist.MovedPoint(at_stamp, m.taken)) - m.distance;
      };
      const double z = behind(0.0) / (behind(0.0) - behind(1.0));
      const Eigen::Vector3d point = twist.MovedPoint(ray * z, -seen);
      cur.u = camera_.fx * point.x() / point.z() + camera_.cx;
      cur.v = camera_.fy * point.y() / point.z() + camera_.cy;
      cur.depth = point.z();
      cur.normal = twist.MotionDuring(-m.taken).rotation * m.normal;
      moved.Add(m.match.prev, cur);
    }
    return moved;
  }

 private:
  struct Measured {
    Match match;  // cur: as seen in its row
    // The surface normal . X = distance at the time of the depth exposure.
    Eigen::Vector3d normal;
    double distance = 0.0;
    double taken = 0.0;  // s after the time stamp
  };

  Camera camera_;
  FrameTiming timing_;
  std::vector<Measured> measured_;
};

VelocityPrior PriorWith(double sigma_angular, double sigma_linear) {
  VelocityPrior prior;
  prior.sigma_angular = sigma_angular;
  prior.sigma_linear = sigma_linear;
  return prior;
}

const Rigid3d kMotion = Rigid3d::FromRotationVector(
    0.03 * Eigen::Vector3d(1, -1, 2).normalized(), {0.03, -0.02, 0.04});

// Of all matches, in one step.
TwistEstimate EstimateOnce(const Correspondences& matches,
                           const FrameTiming& timing, const Twist& prior_mean,
                           const VelocityPrior& prior) {
  return EstimateTwist(matches, std::vector<bool>(matches.size(), true), 1.0,
                       kMotion, timing, prior_mean, prior);
}

// Iterates: each velocity moves the matches, which give a better velocity.
Twist FoundTwist(const RollingMatches& matches, const VelocityPrior& prior,
                 const Twist& prior_mean) {
  Twist twist = prior_mean;
  for (int round = 0; round < 4; ++round) {
    const Correspondences moved = matches.MovedBy(twist);
    twist = EstimateOnce(moved, TimingOf(twist), prior_mean, prior).twist;
  }
  return twist;
}

double TwistError(const Twist& found, const Twist& truth) {
  return (found.angular - truth.angular).norm() +
         (found.linear - truth.linear).norm();
}

TEST(TwistEstimationTest, RowsTellTheVelocity) {
  const RollingMatches exact(TimingOf(kTwist), kMotion, 0.0, 1);
  const VelocityPrior anything = PriorWith(100.0, 100.0);
  // Rows are those of the moved points, ten pixels off.
  EXPECT_LT(TwistError(FoundTwist(exact, anything, Twist()), kTwist), 0.02);
  RollingMatches with_outliers = exact;
  with_outliers.AddOutliers();
  EXPECT_LT(TwistError(FoundTwist(with_outliers, anything, Twist()), kTwist),
            0.1);
}

// Only the depth delay gives information, on slanted surfaces: half of the
// effect on depth comes from their slopes.
TEST(TwistEstimationTest, DepthOfAnotherTimeTellsTheVelocity) {
  for (const double delay : {0.015, -0.015}) {
    const FrameTiming timing = {{}, {delay, 0.0}, kTwist};
    const RollingMatches exact(timing, kMotion, 0.0, 6);
    FrameTiming moved_by = timing;
    moved_by.twist = Twist();
    // In one step, the linear part of the velocity is correct.
    const Correspondences matches = exact.MovedBy(moved_by.twist);
    const Twist found =
        EstimateOnce(matches, moved_by, Twist(), PriorWith(100.0, 100.0)).twist;
    EXPECT_LT(TwistError(found, kTwist), 0.1) << delay;
  }
}

TEST(TwistEstimationTest, OutliersAndMatchesWithoutDepthCountNothing) {
  RollingMatches matches(TimingOf(kTwist), kMotion, 1.0, 2);
  const Correspondences all = matches.MovedBy(Twist());
  matches.AddOutliers();
  const Correspondences some = matches.MovedBy(Twist());
  Correspondences few(all.camera());
  Correspondences no_depth(all.camera());
  std::vector<bool> is_inlier;
  for (size_t i = 0; i < all.size(); ++i) {
    is_inlier.push_back(i % 10 != 0);
    Observation flat = all[i].prev;
    if (i % 10 == 0) {
      flat.depth = flat.sigma_depth = 0.0;
    } else {
      few.Add(all[i].prev, all[i].cur);
    }
    no_depth.Add(flat, all[i].cur);
  }
  const auto estimate = [&](const Correspondences& of,
                            const std::vector<bool>& use) {
    return EstimateTwist(of, use, 1.0, kMotion, TimingOf(Twist()), Twist(),
                         PriorWith(1.0, 1.0));
  };
  const TwistEstimate expected =
      estimate(few, std::vector<bool>(few.size(), true));
  EXPECT_EQ(TwistError(estimate(some, is_inlier).twist, expected.twist), 0.0);
  EXPECT_EQ(
      TwistError(estimate(no_depth, std::vector<bool>(all.size(), true)).twist,
                 expected.twist),
      0.0);
}

// A global shutter neither gives a velocity nor is disturbed by a wrong one.
TEST(TwistEstimationTest, WithoutRowsTheMeanComesBack) {
  const FrameTiming global = {{}, {}, {{0.3, 0.2, 0.1}, {0.1, 0.2, 0.3}}};
  const RollingMatches seen(global, kMotion, 1.0, 3);
  const Correspondences matches = seen.MovedBy(global.twist);
  const TwistEstimate estimate =
      EstimateOnce(matches, global, kTwist, PriorWith(0.1, 0.2));
  EXPECT_LT(TwistError(estimate.twist, kTwist), 1e-12);  // rounding
  EXPECT_LT(estimate.motion_covariance.norm(), 1e-20);
}

// The result is between the rows' velocity and the mean, by their certainty.
TEST(TwistEstimationTest, ACertainMeanIsKept) {
  const RollingMatches matches(TimingOf(kTwist), kMotion, 1.0, 4);
  const Twist mean = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  EXPECT_LT(TwistError(FoundTwist(matches, PriorWith(1e-4, 1e-4), mean), mean),
            1e-3);
  EXPECT_LT(TwistError(FoundTwist(matches, PriorWith(1.0, 1.0), mean), kTwist),
            0.5 * TwistError(mean, kTwist));
}

TEST(TwistEstimationTest, TheLessIsKnownTheWiderTheMotion) {
  const RollingMatches seen(TimingOf(kTwist), kMotion, 1.0, 5);
  const Correspondences matches = seen.MovedBy(kTwist);
  double last = 0.0;
  for (const double sigma : {0.01, 0.03, 0.1, 0.3, 1.0}) {
    const MotionMatrix covariance =
        EstimateOnce(matches, TimingOf(kTwist), kTwist, PriorWith(sigma, sigma))
            .motion_covariance;
    EXPECT_GT(covariance.trace(), last) << sigma;
    EXPECT_LT((covariance - covariance.transpose()).norm(),
              1e-9 * covariance.norm());
    // A velocity acts for as long as the middle row differs from the stamp: 7.5
    // and 18 ms.
    EXPECT_LT(covariance.diagonal().maxCoeff(), 0.018 * 0.018 * sigma * sigma);
    last = covariance.trace();
  }
}

// A reference whose velocity is wrong is sheared like a frame with the opposite
// error.
TEST(TwistEstimationTest, RowsTellNoMoreThanTheReferenceKnows) {
  const RollingMatches seen(TimingOf(kTwist), kMotion, 1.0, 8);
  const Correspondences matches = seen.MovedBy(Twist());
  VelocityPrior prior = PriorWith(0.5, 0.5);
  double last = 0.0;
  for (const double sigma : {0.0, 0.1, 0.5, 1e3}) {
    prior.reference_covariance = IndependentErrors(sigma, sigma);
    const TwistEstimate found =
        EstimateOnce(matches, TimingOf(Twist()), Twist(), prior);
    const double error = TwistError(found.twist, kTwist);
    EXPECT_GT(error, last) << sigma;
    last = error;
    // Between the certainty of the reference and that of the prior.
    EXPECT_LT(found.covariance.diagonal().maxCoeff(), 0.2500001);
    EXPECT_GT(found.covariance.diagonal().minCoeff(),
              0.9 / (1.0 / (0.5 * 0.5) + 1.0 / (sigma * sigma)));
  }
  EXPECT_NEAR(last, TwistError(Twist(), kTwist), 1e-3);
}

TEST(TwistEstimationTest, TheMotionFollowsTheTwist) {
  const RollingMatches seen(TimingOf(kTwist), kMotion, 1.0, 9);
  Estimator estimator({}, MakeRobustCosts());
  const MotionEstimate before =
      estimator.Estimate(seen.MovedBy(kTwist), kMotion);
  const TwistEstimate found = EstimateTwist(
      seen.MovedBy(kTwist), before.is_inlier, before.sigma,
      before.cur_from_prev, TimingOf(kTwist), kTwist, PriorWith(1.0, 1.0));
  for (int i = 0; i < 6; ++i) {
    MotionVector change = MotionVector::Zero();
    change[i] = 0.05;
    const Twist other = {kTwist.angular + change.head<3>(),
                         kTwist.linear + change.tail<3>()};
    const MotionEstimate after =
        estimator.Estimate(seen.MovedBy(other), before.cur_from_prev);
    const Rigid3d moved = after.cur_from_prev * before.cur_from_prev.Inverse();
    MotionVector motion;
    motion << RotationVector(moved.rotation), moved.translation;
    const MotionVector expected = found.motion_by_twist * change;
    // The solve weighs its residuals a little differently.
    EXPECT_LT((motion - expected).norm(), 0.25 * expected.norm()) << i;
  }
}

// As in the tracker: the velocity starts from the mean, the motion uses the
// moved matches. The velocities' spread around the mean follows the prior.
TEST(TwistEstimationTest, TheCovarianceIsHonest) {
  constexpr int kTrials = 60;
  constexpr double kAngular = 0.3, kLinear = 0.2;
  Estimator estimator({}, MakeRobustCosts());
  double with = 0.0, without = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomWorld world(100 + trial);
    Twist truth = kTwist;
    for (int i = 0; i < 3; ++i) truth.angular[i] += world.Normal(kAngular);
    for (int i = 0; i < 3; ++i) truth.linear[i] += world.Normal(kLinear);
    const RollingMatches matches(TimingOf(truth), kMotion, 1.0, 500 + trial);
    Twist twist = kTwist;
    MotionEstimate estimate =
        estimator.Estimate(matches.MovedBy(twist), kMotion);
    MotionMatrix more;
    for (int round = 0; round < 3; ++round) {
      const TwistEstimate found =
          EstimateTwist(matches.MovedBy(twist), estimate.is_inlier,
                        estimate.sigma, estimate.cur_from_prev, TimingOf(twist),
                        kTwist, PriorWith(kAngular, kLinear));
      twist = found.twist;
      more = found.motion_covariance;
      estimate = estimator.Estimate(matches.MovedBy(twist), kMotion);
    }
    ASSERT_TRUE(estimate.ok()) << estimate.reason;
    const Eigen::AngleAxisd omega(kMotion.rotation *
                                  estimate.cur_from_prev.rotation.inverse());
    MotionVector error;
    error << omega.angle() * omega.axis(),
        kMotion.Inverse().translation -
            estimate.cur_from_prev.Inverse().translation;
    const MotionMatrix known = estimate.covariance;
    with += error.dot((known + more).ldlt().solve(error)) / kTrials;
    without += error.dot(known.ldlt().solve(error)) / kTrials;
  }
  RecordProperty("nees", std::to_string(with));
  // The mean is six; its sigma over so many trials is 0.45. With a loss and a
  // velocity, the result is not exactly that of least squares.
  EXPECT_NEAR(with, 6.0, 2.0);
  EXPECT_GT(without, 1.5 * with);
}

}  // namespace
}  // namespace rgbd_pose
