#pragma once

#include <Eigen/Geometry>
#include <random>

#include "core/estimation/correspondences.h"
#include "core/geometry/depth_noise.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Random motions and matches with Kinect noise, outliers and missing depths,
// for tests, benchmarks and experiments. A seed gives the same numbers on every
// platform with the same standard library.
class RandomWorld {
 public:
  // The seed determines all numbers.
  explicit RandomWorld(unsigned seed)
      : generator_(seed), extra_generator_(~seed) {}

  // A number in [low, high), uniformly distributed.
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

  // A number with mean 0 and this standard deviation, which may be 0, normally
  // distributed.
  double Normal(double sigma) {
    return sigma * std::normal_distribution<double>()(generator_);
  }

  // A vector in the cube of -size to size.
  Eigen::Vector3d Vector(double size) {
    return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)};
  }

  // Rotation about a random axis by up to `max_angle` (rad), translation by up
  // to `max_translation` (m) along each axis.
  Rigid3d Motion(double max_angle, double max_translation) {
    // One statement per draw: the evaluation order of arguments is open.
    const Eigen::Vector3d axis = Vector(1.0).normalized();
    const Eigen::Vector3d translation = Vector(max_translation);
    const Eigen::AngleAxisd rotation(Uniform(0.0, max_angle), axis);
    return Rigid3d(Eigen::Quaterniond(rotation), translation);
  }

  // A noiseless match of a random point at 1-4 m, with Kinect sigmas and a
  // tracking sigma of 0.5 px in each frame.
  void Match(const Camera& camera, const Rigid3d& cur_from_prev,
             Observation* prev, Observation* cur) {
    Eigen::Vector3d point;
    do {
      PlaceAnywhere(camera, prev);
      point = cur_from_prev * Correspondences(camera).Point(*prev);
    } while (point.z() < 0.5);
    cur->u = camera.fx * point.x() / point.z() + camera.cx;
    cur->v = camera.fy * point.y() / point.z() + camera.cy;
    cur->depth = point.z();
    for (Observation* o : {prev, cur}) {
      o->sigma_px = 0.5;
      o->sigma_depth =
          FindNamed(DepthNoiseModels(), "khoshelham")->sigma(o->depth);
    }
  }

  // Adds noise with the observation's own sigmas.
  void AddNoise(Observation* o) {
    o->u += Normal(o->sigma_px);
    o->v += Normal(o->sigma_px);
    o->depth += Normal(o->sigma_depth);
  }

  // Matches with noise, a share of them at a random place and depth in the
  // current frame. All current points have a random normal that faces the
  // camera. In each frame a share of the depths is missing at random.
  Correspondences Matches(int count, double outlier_share,
                          const Rigid3d& cur_from_prev, bool noise = true,
                          double missing_depth_share = 0.0) {
    const Camera camera;
    Correspondences matches(camera);
    for (int i = 0; i < count; ++i) {
      Observation prev, cur;
      Match(camera, cur_from_prev, &prev, &cur);
      if (noise) {
        AddNoise(&prev);
        AddNoise(&cur);
      }
      if (i < outlier_share * count) PlaceAnywhere(camera, &cur);
      cur.normal = FacingNormal(matches.Point(cur));
      for (Observation* o : {&prev, &cur}) {
        if (Extra(0.0, 1.0) < missing_depth_share) o->depth = 0.0;
      }
      matches.Add(prev, cur);
    }
    return matches;
  }

  // A predicted motion whose error is drawn from its covariance. The covariance
  // is random: all six parts are correlated, each of about `sigma` (rad, m).
  MotionPrior Prior(const Rigid3d& truth, double sigma) {
    // (I + v v^T)^-1 = I - v v^T / (1 + v^T v)
    MotionVector unit, v;
    std::normal_distribution<double> normal;
    for (double& value : unit) value = normal(extra_generator_);
    for (double& value : v) value = Extra(-1.0, 1.0);
    MotionPrior prior;
    prior.information =
        (MotionMatrix::Identity() - v * v.transpose() / (1.0 + v.dot(v))) /
        (sigma * sigma);
    const MotionVector error = sigma * (unit + normal(extra_generator_) * v);
    const Rigid3d turn =
        Rigid3d::FromRotationVector(-error.head<3>(), {0, 0, 0});
    const Eigen::Vector3d C = truth.Inverse().translation - error.tail<3>();
    prior.mean.rotation = turn.rotation * truth.rotation;
    prior.mean.translation = -(prior.mean.rotation * C);
    return prior;
  }

 private:
  // Moves an observation to a random pixel and depth.
  void PlaceAnywhere(const Camera& camera, Observation* o) {
    o->u = Uniform(0.0, camera.width - 1.0);
    o->v = Uniform(0.0, camera.height - 1.0);
    o->depth = Uniform(1.0, 4.0);
  }

  double Extra(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(extra_generator_);
  }

  // A random unit normal, uniform on the hemisphere that faces the camera.
  Eigen::Vector3d FacingNormal(const Eigen::Vector3d& point) {
    Eigen::Vector3d n;
    do {
      n = {Extra(-1.0, 1.0), Extra(-1.0, 1.0), Extra(-1.0, 1.0)};
    } while (n.squaredNorm() > 1.0 || n.squaredNorm() < 1e-4);
    return (n.dot(point) > 0.0 ? -n : n).normalized();
  }

  std::mt19937 generator_;
  std::mt19937 extra_generator_;  // separate: other numbers stay the same
};

// A random motion and a match (or prior) at which a residual type can be
// evaluated, for tests, benchmarks and rgbd_jacobians.
template <typename Residual>
struct ResidualSample {
  LinearizationPoint origin;           // linearisation point
  MotionVector x;                      // the motion relative to `origin`
  double columns[Residual::kColumns];  // the match as packed by the type

  explicit ResidualSample(RandomWorld* world) {
    // Enough matches without depth on one side, for residuals that use them.
    constexpr double kMissingDepthShare = 0.25;
    // Some motions turn the camera away from all that it has seen.
    const Eigen::Vector3d middle(0.0, 0.0, 4.0);
    Rigid3d motion;
    do {
      origin = LinearizationPoint(world->Motion(1.0, 1.0));
      x << world->Vector(0.7), world->Vector(0.7);
      motion = origin.CurFromPrev(x.data());
    } while ((motion * middle).z() < 0.5);
    const MotionPrior prior = world->Prior(motion, 0.3);
    while (true) {
      const Correspondences matches =
          world->Matches(1, 0.0, motion, /*noise=*/true, kMissingDepthShare);
      if (Residual::Pack({matches, motion, &prior}, 0, columns)) return;
    }
  }
};

}  // namespace rgbd_pose
