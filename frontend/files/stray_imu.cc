#include "frontend/files/stray_imu.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/util/quantile.h"

namespace rgbd_pose {

void ConvertStrayImu(ImuRecording* recording) {
  constexpr double kStandardGravity = 9.80665;  // m/s^2 per g
  constexpr double kLeastMetric = 3.0;          // between 1 (g) and 9.81
  std::vector<double> sizes;
  for (const ImuSample& sample : recording->samples) {
    sizes.push_back(sample.accel.norm());
  }
  // Core Motion gives gravity less the acceleration, the negative of what an
  // accelerometer measures.
  const double factor = Median(sizes) < kLeastMetric ? -kStandardGravity : -1.0;
  for (ImuSample& sample : recording->samples) sample.accel *= factor;
  // Core Motion has x to the right and y to the top of the upright screen, z
  // out of it. The images are those of the phone in landscape with the home
  // button at the right: x of the camera points from the front camera to that
  // button, y down, z away from the screen.
  Eigen::Matrix3d cam_from_device;
  cam_from_device << 0, -1, 0,  //
      -1, 0, 0,                 //
      0, 0, -1;
  recording->cam_from_imu =
      Rigid3d(Eigen::Quaterniond(cam_from_device), Eigen::Vector3d::Zero());
}

}  // namespace rgbd_pose
