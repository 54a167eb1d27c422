#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/inertial/camera_imu.h"
#include "tests/support/imu_path.h"

namespace rgbd_pose {

// A shaking hand (ImuPath) that holds a camera and a noisy inertial sensor
// beside it, whose calibration may err. Images show poses with errors.
struct CameraWithImu {
  explicit CameraWithImu(unsigned seed = 1) : random(seed) {
    truth.cam_from_imu =
        Rigid3d::FromRotationVector({0.5, -1.0, 0.3}, {0.05, -0.1, 0.02});
    truth.delay_s = 0.3;
    truth.noise = ImuNoise();
    bias << 0.01, -0.02, 0.015, 0.1, -0.05, 0.08;
  }

  Rigid3d WorldFromCam(double t) const {
    const PoseOf<double> pose = hand.Pose(t);
    return Rigid3d(pose.q, pose.p) * truth.cam_from_imu->Inverse();
  }

  std::vector<ImuSample> Samples(double from, double to) {
    constexpr double kRate = 200.0;
    std::vector<ImuSample> samples =
        ImuErrors(*truth.noise, bias, random())
            .On(hand.Samples(from, to, kRate), kRate);
    for (ImuSample& sample : samples) sample.stamp += *truth.delay_s;
    return samples;
  }

  // A pose with errors of these standard deviations, rad and m.
  Rigid3d Seen(double t, double turn, double shift) {
    return WorldFromCam(t) *
           Rigid3d::FromRotationVector(Normal(turn), Normal(shift));
  }

  // Shows the turns of the path to a sensor, as images do, five each second.
  void Teach(double from, double to, double turn, CameraImu* imu) {
    constexpr double kStep = 0.2;
    Rigid3d last = Seen(from, turn, 0.0);
    for (double t = from; t + kStep <= to; t += kStep) {
      const Rigid3d next = Seen(t + kStep, turn, 0.0);
      imu->Learn(t, t + kStep,
                 {next.rotation.conjugate() * last.rotation,
                  2.0 * turn * turn * Eigen::Matrix3d::Identity()});
      last = next;
    }
  }

  Eigen::Vector3d Normal(double sigma) {
    return sigma *
           Eigen::Vector3d(normal(random), normal(random), normal(random));
  }

  ImuPath hand;
  ImuCalibration truth;
  ImuBiasVector bias;
  std::mt19937 random;
  std::normal_distribution<double> normal;
};

}  // namespace rgbd_pose
