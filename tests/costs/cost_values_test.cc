// The values of every cost, computed independently with Eigen's matrices and,
// for covariances, by finite differences. None of the costs' own code is used.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "costs/cost_factory.h"
#include "costs/matches/epipolar.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr double kValueTolerance = 1e-6;  // second-order differences
constexpr double kStep = 1e-5;
constexpr int kValueMatches = 50;

using Measured = Eigen::Vector3d;  // u, v, depth

Measured MeasuredOf(const Observation& o) { return {o.u, o.v, o.depth}; }

Eigen::Vector3d PointOf(const Camera& camera, const Measured& m) {
  return camera.Unproject(m.head<2>(), m.z());
}

// A measured point as the other camera sees it: u, v, inverse depth.
Eigen::Vector3d SeenFrom(const Camera& camera, const Rigid3d& other_from_this,
                         const Measured& m) {
  const Eigen::Vector3d point = other_from_this * PointOf(camera, m);
  const Eigen::Vector2d pixel = camera.Project(point);
  return {pixel.x(), pixel.y(), 1.0 / point.z()};
}

// Covariance of f(u, v, depth) caused by the noise of an observation.
template <typename F>
Eigen::Matrix3d Propagate(const Observation& o, F f) {
  const Eigen::Vector3d sigma(o.sigma_px, o.sigma_px, o.sigma_depth);
  Eigen::Matrix3d spread;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
    const Eigen::Vector3d up = f(MeasuredOf(o) + step);
    const Eigen::Vector3d down = f(MeasuredOf(o) - step);
    spread.col(k) = sigma[k] * (up - down) / (2.0 * kStep);
  }
  return spread * spread.transpose();
}

Eigen::VectorXd Whiten(const Eigen::MatrixXd& covariance,
                       const Eigen::VectorXd& e) {
  return covariance.llt().matrixL().solve(e);
}

// A cost that is bound at one motion and evaluated at another.
class CostValuesTest : public ::testing::Test {
 protected:
  CostValuesTest() : world_(5) {
    bound_ = world_.Motion(0.1, 0.1);
    motion_ = world_.Motion(0.02, 0.02) * bound_;
    prior_ = world_.Prior(motion_, 0.05);
    matches_ = world_.Matches(kValueMatches, 0.0, motion_);
  }

  Eigen::Matrix3d R() const { return motion_.rotation.toRotationMatrix(); }
  Eigen::Vector3d C() const { return motion_.Inverse().translation; }

  Eigen::Vector3d ForwardError(size_t i) const {
    return matches_.Point(matches_[i].cur) -
           motion_ * matches_.Point(matches_[i].prev);
  }

  // Covariance of the forward error at the bound motion.
  Eigen::Matrix3d ForwardCovariance(size_t i) const {
    const Camera& camera = matches_.camera();
    return Propagate(matches_[i].cur,
                     [&](const Measured& m) { return PointOf(camera, m); }) +
           Propagate(matches_[i].prev, [&](const Measured& m) {
             return bound_ * PointOf(camera, m);
           });
  }

  // u, v and inverse depth of `target`, minus their prediction from `source`.
  Eigen::Vector3d ImageError(const Observation& source,
                             const Observation& target,
                             const Rigid3d& target_from_source) const {
    return Eigen::Vector3d(target.u, target.v, 1.0 / target.depth) -
           SeenFrom(matches_.camera(), target_from_source, MeasuredOf(source));
  }

  Eigen::Matrix3d ImageCovariance(const Observation& source,
                                  const Observation& target,
                                  const Rigid3d& target_from_source) const {
    const auto measured = [](const Measured& m) {
      return Eigen::Vector3d(m.x(), m.y(), 1.0 / m.z());
    };
    const auto predicted = [&](const Measured& m) {
      return SeenFrom(matches_.camera(), target_from_source, m);
    };
    return Propagate(target, measured) + Propagate(source, predicted);
  }

  // Compares all residuals of a cost with a function of the match's index.
  void Expect(const std::string& name,
              const std::function<Eigen::VectorXd(size_t)>& expected) {
    const std::unique_ptr<MotionCost> cost = MakeCost(name);
    cost->Bind({&matches_, &prior_});
    cost->Associate(bound_);
    const MotionVector zero = MotionVector::Zero();
    std::vector<double> residuals;
    cost->Residuals(LinearizationPoint(motion_).DerivativesAt(zero.data()),
                    &residuals);
    ASSERT_EQ(residuals.size(), cost->matches().size() * cost->num_residuals());
    ASSERT_FALSE(residuals.empty());
    for (size_t k = 0; k < cost->matches().size(); ++k) {
      const Eigen::Map<Eigen::VectorXd> actual(
          &residuals[k * cost->num_residuals()], cost->num_residuals());
      const Eigen::VectorXd value = expected(cost->matches()[k]);
      EXPECT_LE((actual - value).norm(), kValueTolerance * value.norm())
          << name << ", match " << k;
    }
  }

  RandomWorld world_;
  Rigid3d bound_, motion_;
  MotionPrior prior_;
  Correspondences matches_;
};

TEST_F(CostValuesTest, BidirectionalPoint) {
  // An upper triangle of S^-1 = L L^T whitens along u, v, depth.
  const auto whiten = [&](const Observation& o, const Eigen::Vector3d& e) {
    const Eigen::Matrix3d information = Propagate(o, [&](const Measured& m) {
                                          return PointOf(matches_.camera(), m);
                                        }).inverse();
    return Eigen::Vector3d(information.llt().matrixL().transpose() * e / 2.0);
  };
  Expect("bidirectional_point", [&](size_t i) {
    const Observation prev = matches_[i].prev, cur = matches_[i].cur;
    Eigen::VectorXd r(6);
    r << whiten(cur, ForwardError(i)),
        whiten(prev,
               matches_.Point(prev) - motion_.Inverse() * matches_.Point(cur));
    return r;
  });
}

TEST_F(CostValuesTest, PointToPoint) {
  Expect("point_to_point", [&](size_t i) -> Eigen::VectorXd {
    return ForwardError(i) / std::sqrt(ForwardCovariance(i).trace() / 3.0);
  });
}

TEST_F(CostValuesTest, MahalanobisPoint) {
  Expect("mahalanobis_point", [&](size_t i) {
    return Whiten(ForwardCovariance(i), ForwardError(i));
  });
}

TEST_F(CostValuesTest, PointToPlane) {
  Expect("point_to_plane", [&](size_t i) {
    const Eigen::Vector3d n = matches_[i].cur.normal;
    const double variance = n.transpose() * ForwardCovariance(i) * n;
    return Eigen::VectorXd::Constant(
        1, n.dot(ForwardError(i)) / std::sqrt(variance));
  });
}

TEST_F(CostValuesTest, Reprojection) {
  Expect("reprojection", [&](size_t i) {
    const Observation prev = matches_[i].prev, cur = matches_[i].cur;
    return Whiten(ImageCovariance(prev, cur, bound_).topLeftCorner<2, 2>(),
                  ImageError(prev, cur, motion_).head<2>());
  });
}

TEST_F(CostValuesTest, ReprojectionDepth) {
  Expect("reprojection_depth", [&](size_t i) {
    const Observation prev = matches_[i].prev, cur = matches_[i].cur;
    return Whiten(ImageCovariance(prev, cur, bound_),
                  ImageError(prev, cur, motion_));
  });
}

TEST_F(CostValuesTest, BidirectionalImage) {
  Expect("bidirectional_image", [&](size_t i) {
    const Observation prev = matches_[i].prev, cur = matches_[i].cur;
    Eigen::VectorXd r(6);
    r << Whiten(ImageCovariance(prev, cur, bound_),
                ImageError(prev, cur, motion_)),
        Whiten(ImageCovariance(cur, prev, bound_.Inverse()),
               ImageError(cur, prev, motion_.Inverse()));
    return Eigen::VectorXd(r / std::sqrt(2.0));
  });
}

// With depth on one side: u and v in the direction that can be projected.
TEST_F(CostValuesTest, BidirectionalImageWithDepthOnOneSide) {
  Correspondences partial(matches_.camera());
  for (size_t i = 0; i < matches_.size(); ++i) {
    Observation prev = matches_[i].prev, cur = matches_[i].cur;
    (i % 2 == 0 ? prev : cur).depth = 0.0;
    partial.Add(prev, cur);
  }
  const Correspondences whole = matches_;
  matches_ = partial;
  Expect("bidirectional_image", [&](size_t i) {
    const Observation prev = whole[i].prev, cur = whole[i].cur;
    Eigen::VectorXd r = Eigen::VectorXd::Zero(6);
    if (i % 2 == 1) {
      r.head<2>() =
          Whiten(ImageCovariance(prev, cur, bound_).topLeftCorner<2, 2>(),
                 ImageError(prev, cur, motion_).head<2>());
    } else {
      r.segment<2>(3) = Whiten(
          ImageCovariance(cur, prev, bound_.Inverse()).topLeftCorner<2, 2>(),
          ImageError(cur, prev, motion_.Inverse()).head<2>());
    }
    return r;
  });
}

TEST_F(CostValuesTest, Epipolar) {
  Correspondences without_depth(matches_.camera());
  for (size_t i = 0; i < matches_.size(); ++i) {
    Observation prev = matches_[i].prev, cur = matches_[i].cur;
    prev.depth = cur.depth = 0.0;
    without_depth.Add(prev, cur);
  }
  matches_ = without_depth;
  bound_ = motion_;  // otherwise most matches are not used
  const Camera& camera = matches_.camera();
  const auto N = [&](const Eigen::Vector4d& pixels) {
    const Eigen::Vector3d prev = camera.Unproject(pixels.head<2>(), 1.0);
    const Eigen::Vector3d cur = camera.Unproject(pixels.tail<2>(), 1.0);
    return cur.dot(R() * C().cross(prev));
  };
  Expect("epipolar", [&](size_t i) {
    const Observation prev = matches_[i].prev, cur = matches_[i].cur;
    const Eigen::Vector4d at(prev.u, prev.v, cur.u, cur.v);
    // Both frames are equally noisy here, and fx = fy.
    double variance =
        std::pow(prev.sigma_px / camera.fx * Epipolar::kRestBaseline, 2);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector4d step = kStep * Eigen::Vector4d::Unit(k);
      const double slope = (N(at + step) - N(at - step)) / (2.0 * kStep);
      variance += std::pow(slope * prev.sigma_px, 2);
    }
    return Eigen::VectorXd::Constant(1, N(at) / std::sqrt(variance));
  });
}

TEST_F(CostValuesTest, MotionPrior) {
  // R = Exp(omega) R_p: the residual contains the axis times the sine.
  const Eigen::AngleAxisd turn(motion_.rotation *
                               prior_.mean.rotation.inverse());
  MotionVector e;
  e << std::sin(turn.angle()) * turn.axis(),
      C() - prior_.mean.Inverse().translation;
  Expect("motion_prior",
         [&](int) { return Whiten(prior_.information.inverse(), e); });
}

TEST_F(CostValuesTest, OnlyAPriorThatTellsSomethingIsUsed) {
  const std::unique_ptr<MotionCost> cost = MakeCost("motion_prior");
  const auto is_used = [&](const MotionPrior* prior) {
    cost->Bind({&matches_, prior});
    cost->Associate(bound_);
    EXPECT_THAT(cost->matches(), testing::Each(-1));
    return cost->matches().size() == 1;
  };
  EXPECT_FALSE(is_used(nullptr));
  MotionPrior zero = prior_, not_finite = prior_;
  zero.information.setZero();
  not_finite.information(3, 2) = std::nan("");
  EXPECT_FALSE(is_used(&zero));
  EXPECT_FALSE(is_used(&not_finite));
  // However vague or exact it is.
  for (const double factor : {1e-20, 1.0, 1e20}) {
    MotionPrior scaled = prior_;
    scaled.information *= factor;
    EXPECT_TRUE(is_used(&scaled)) << factor;
    scaled.information(3, 3) *= -1.0;
    EXPECT_FALSE(is_used(&scaled)) << factor;
  }
}

// An inertial sensor, for example, only measures rotation.
TEST_F(CostValuesTest, APriorMayTellOfSomeDirectionsOnly) {
  const MotionMatrix all = prior_.information;
  prior_.information.setZero();
  prior_.information.topLeftCorner<3, 3>() = all.topLeftCorner<3, 3>();
  const Eigen::AngleAxisd turn(motion_.rotation *
                               prior_.mean.rotation.inverse());
  const Eigen::Vector3d e = std::sin(turn.angle()) * turn.axis();
  const std::unique_ptr<MotionCost> cost = MakeCost("motion_prior");
  cost->Bind({&matches_, &prior_});
  ASSERT_EQ(cost->matches(), std::vector<int>{-1});
  const MotionVector zero = MotionVector::Zero();
  std::vector<double> norms;
  cost->SquaredNorms(LinearizationPoint(motion_).DerivativesAt(zero.data()),
                     &norms);
  const double expected = e.dot(all.topLeftCorner<3, 3>() * e);
  EXPECT_NEAR(norms[0], expected, 1e-9 * expected);
}

}  // namespace
}  // namespace rgbd_pose
