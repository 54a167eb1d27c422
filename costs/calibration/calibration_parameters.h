#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <string>

#include "core/factors/blocks.h"
#include "core/geometry/camera.h"

namespace rgbd_pose {

// The calibration parameters of an RGB-D camera.
enum CalibrationIndex {
  kFx,  // focal lengths and principal point, px
  kFy,
  kCx,
  kCy,
  kK1,  // radial distortion
  kK2,
  kK3,
  kK4,  // equidistant lenses only
  kP1,  // tangential distortion, all other lenses
  kP2,
  kInverseDepth,  // 1 / z = 1 / measured z + this, 1/m
  kDepthTime,     // delay of depth after its time stamp, s
  kColorReadout,  // time from the first row to the last, beyond what has been
  kDepthReadout,  // corrected already, s
  kRotationX,     // in the registered depth image a point X of the colour axes
  kRotationY,     // is at Exp(rotation) X + translation: rad
  kRotationZ,
  kTranslationX,  // m
  kTranslationY,
  kTranslationZ,
  kDepthFactor,  // z = this * measured z, not counting the offset of 1 / z
  kCalibrationSize
};

// The parameters of the lens are the first.
inline constexpr int kLensSize = kInverseDepth;
inline constexpr int kDistortionSize = kLensSize - kK1;

// A value, and a covariance, of all parameters in the order above.
using CalibrationVector = Eigen::Matrix<double, kCalibrationSize, 1>;
using CalibrationMatrix =
    Eigen::Matrix<double, kCalibrationSize, kCalibrationSize>;

// Which of the parameters are free.
using FreeParts = std::bitset<kCalibrationSize>;

// One row of the table of parameters.
struct CalibrationParameter {
  const char* name;  // in files and reports
  const char* what;  // description
  const char* unit;  // of the value, as text

  // Standard deviation of the prior; for focal lengths, relative to the focal
  // length.
  double prior;

  // Lower limit of every error bar, for errors that residuals do not show (a
  // bias of features in all views, curved surfaces), from simulated recordings.
  double floor;
};

// In the order of CalibrationIndex.
inline constexpr std::array<CalibrationParameter, kCalibrationSize>
    kCalibrationParameters = {{
        {"fx", "focal length along x", "px", 0.02, 0.06},
        {"fy", "focal length along y", "px", 0.02, 0.06},
        {"cx", "principal point, x", "px", 10.0, 0.05},
        {"cy", "principal point, y", "px", 10.0, 0.05},
        {"k1", "radial distortion, r^2", "", 0.1, 1.5e-4},
        {"k2", "radial distortion, r^4", "", 0.2, 2e-4},
        {"k3", "radial distortion, r^6", "", 0.5, 2e-4},
        {"k4", "radial distortion, t^8", "", 0.1, 2e-4},
        {"p1", "tangential distortion, along y", "", 0.005, 8e-5},
        {"p2", "tangential distortion, along x", "", 0.005, 8e-5},
        {"inverse_depth_offset", "offset of inverse depth", "1/m", 0.02, 6e-5},
        {"depth_time_offset", "delay of depth after its time stamp", "s", 0.02,
         1.5e-5},
        {"color_readout", "readout of colour", "s", 0.02, 1e-4},
        {"depth_readout", "readout of depth", "s", 0.02, 1e-4},
        {"rotation_x", "registration of depth, rotation about x", "rad", 0.02,
         1.4e-4},
        {"rotation_y", "registration of depth, rotation about y", "rad", 0.02,
         1.4e-4},
        {"rotation_z", "registration of depth, rotation about z", "rad", 0.02,
         1.4e-4},
        {"translation_x", "registration of depth, along x", "m", 0.02, 3.7e-4},
        {"translation_y", "registration of depth, along y", "m", 0.02, 3.7e-4},
        {"translation_z", "registration of depth, along z", "m", 0.02, 3.7e-4},
        {"depth_factor", "metres per measured metre", "", 0.05, 0.0},
    }};

// The floor for a recording with this many keyframes. Shared errors average out
// over views; the table is for recordings with many keyframes.
inline double CalibrationFloor(int parameter, int keyframes) {
  constexpr double kMany = 150.0;
  return kCalibrationParameters[parameter].floor *
         std::sqrt(std::max(1.0, kMany / std::max(1, keyframes)));
}

// The numbers y of a CalibrationBlock in standard deviations of the prior:
// theta = start + width . y. By default they are theta itself.
struct CalibrationOrigin {
  // theta at y = 0
  CalibrationVector start = CalibrationVector::Zero();
  // of one y; 0: the parameter is fixed
  CalibrationVector width = CalibrationVector::Ones();

  // theta at y, for any scalar.
  template <typename T>
  Eigen::Matrix<T, kCalibrationSize, 1> At(
      const Eigen::Matrix<T, kCalibrationSize, 1>& y) const {
    Eigen::Matrix<T, kCalibrationSize, 1> theta;
    for (int k = 0; k < kCalibrationSize; ++k) {
      theta[k] = start[k] + width[k] * y[k];
    }
    return theta;
  }

  // y at theta; 0 for fixed parameters.
  CalibrationVector NumbersOf(const CalibrationVector& theta) const {
    CalibrationVector y = CalibrationVector::Zero();
    for (int k = 0; k < kCalibrationSize; ++k) {
      if (width[k] > 0.0) y[k] = (theta[k] - start[k]) / width[k];
    }
    return y;
  }
};

// The calibration parameters as a block of a Ceres problem.
struct CalibrationBlock : VectorBlock<kCalibrationSize> {
  static constexpr char kName[] = "calibration";  // for messages

  // A number of the block in words.
  static std::string NameOf(int k) { return kCalibrationParameters[k].name; }
};

// What all factors of one CalibrationBlock share.
struct CalibrationModel {
  Camera camera;             // the lens' model, and what theta lacks of it
  CalibrationOrigin origin;  // of the block's numbers
};

}  // namespace rgbd_pose
