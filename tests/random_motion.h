#pragma once

#include <Eigen/Geometry>
#include <random>

#include "core/correspondences.h"
#include "core/depth_noise.h"
#include "core/rigid3.h"

namespace rgbd_pose {

// Random worlds for tests; the same on every platform for one seed as far as
// the standard library's normal distribution is.
class RandomWorld {
 public:
  explicit RandomWorld(unsigned seed) : generator_(seed) {}

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

  double Normal(double sigma) {
    return std::normal_distribution<double>(0.0, sigma)(generator_);
  }

  Eigen::Vector3d Vector(double size) {
    return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)};
  }

  Rigid3d Motion(double max_angle, double max_translation) {
    const Eigen::Vector3d axis = Vector(1.0).normalized();
    return Rigid3d(
        Eigen::Quaterniond(Eigen::AngleAxisd(Uniform(0.0, max_angle), axis)),
        Vector(max_translation));
  }

  // A noiseless match of a random point at 1-4 m, with Kinect sigmas and a
  // tracking noise of 0.5 px in each frame.
  void Match(const Camera& camera, const Rigid3d& cur_from_prev,
             Observation* prev, Observation* cur) {
    while (true) {
      prev->u = Uniform(0.0, camera.width - 1.0);
      prev->v = Uniform(0.0, camera.height - 1.0);
      prev->depth = Uniform(1.0, 4.0);
      const Eigen::Vector3d point =
          cur_from_prev * Correspondences(camera).Point(*prev);
      if (point.z() < 0.5) continue;
      cur->u = camera.fx * point.x() / point.z() + camera.cx;
      cur->v = camera.fy * point.y() / point.z() + camera.cy;
      cur->depth = point.z();
      for (Observation* o : {prev, cur}) {
        o->sigma_px = 0.5;
        o->sigma_depth = FindDepthNoiseModel("khoshelham")->sigma(o->depth);
      }
      return;
    }
  }

  // Disturbs an observation by its own sigmas.
  void AddNoise(Observation* o) {
    o->u += Normal(o->sigma_px);
    o->v += Normal(o->sigma_px);
    o->depth += Normal(o->sigma_depth);
  }

  // Matches with noise, of which a share points to a random place and depth.
  Correspondences Matches(int count, double outlier_share,
                          const Rigid3d& cur_from_prev, bool noise = true) {
    const Camera camera;
    Correspondences matches(camera);
    for (int i = 0; i < count; ++i) {
      Observation prev, cur;
      Match(camera, cur_from_prev, &prev, &cur);
      if (noise) {
        AddNoise(&prev);
        AddNoise(&cur);
      }
      if (i < outlier_share * count) {
        cur.u = Uniform(0.0, camera.width - 1.0);
        cur.v = Uniform(0.0, camera.height - 1.0);
        cur.depth = Uniform(1.0, 4.0);
      }
      matches.Add(prev, cur);
    }
    return matches;
  }

 private:
  std::mt19937 generator_;
};

}  // namespace rgbd_pose
