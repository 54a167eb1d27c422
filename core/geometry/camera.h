#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/depth_noise.h"
#include "core/geometry/lens.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"
#include "core/util/named_values.h"

namespace rgbd_pose {

// A pinhole camera with lens distortion (equations in core/geometry/lens.h).
// Optical axes: x right, y down, z forward. Pixel (0, 0) is the centre of the
// upper left pixel. Lengths are in pixels.
struct Camera {
  // Image size.
  int width = 640;
  int height = 480;

  // Focal lengths and principal point.
  double fx = 525.0;
  double fy = 525.0;
  double cx = 319.5;
  double cy = 239.5;

  // Distortion: radial k, tangential p. An equidistant lens uses k1 to k4.
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;
  double k4 = 0.0;
  double k5 = 0.0;
  double k6 = 0.0;

  // The model that the coefficients belong to.
  LensModel lens_model = LensModel::kRational;

  // One line that says what is wrong with the parameters, or empty.
  std::string Check() const;

  // One line that says what is unusual, or empty: fx and fy that differ by more
  // than 5 %, or a principal point off the image centre by more than a tenth of
  // the image size. Usually numbers were swapped or belong to another size.
  std::string SanityWarning() const;

  // The distortion functions, with coefficients of type S.
  template <typename S = double>
  Lens<S> MakeLens() const {
    using Factor = typename Lens<S>::Factor;
    Factor factor = Factor::kNone;
    if (lens_model == LensModel::kEquidistant) {
      factor = Factor::kEquidistant;
    } else if (k4 != 0.0 || k5 != 0.0 || k6 != 0.0) {
      factor = Factor::kRational;
    } else if (HasDistortion()) {
      factor = Factor::kPolynomial;
    }
    return {factor, S(k1), S(k2), S(p1), S(p2), S(k3), S(k4), S(k5), S(k6)};
  }

  // Whether the lens distorts; an equidistant lens always does.
  bool HasDistortion() const;

  // The coefficients in the order of OpenCV and ROS: k1 k2 p1 p2 k3, followed
  // by k4 k5 k6 if one of these is not 0; k1 k2 k3 k4 for an equidistant lens.
  std::vector<double> Distortion() const;

  // Takes 4, 5 or 8 coefficients, or more if those after the eighth are 0; 4
  // for an equidistant lens. Otherwise returns false and changes nothing.
  bool SetDistortion(LensModel model, const std::vector<double>& coefficients);

  // Image point (distorted px) of a point in camera axes; z must be > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& point) const;

  // Derivative of Project (px) with respect to `place` on the plane z = 1.
  Eigen::Matrix2d ProjectDerivative(const Eigen::Vector2d& place) const;

  // Ideal pixel (no distortion) of an image pixel, to 1e-10 px. NaN if there is
  // none: beyond 90 degrees, or where the lens polynomial is not invertible.
  Eigen::Vector2d Undistort(const Eigen::Vector2d& pixel) const;

  // The ray (a, b, 1) of an ideal pixel; times the depth, it is the point.
  Eigen::Vector3d Ray(double u, double v) const {
    return {(u - cx) / fx, (v - cy) / fy, 1.0};
  }

  // Point in camera axes (m) of an image pixel (distorted) at a depth z (m).
  Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel, double depth) const;

  // Whether a point is in the image and at least `border_px` from its border.
  bool Contains(const Eigen::Vector2d& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px &&
           pixel.x() <= width - 1 - border_px &&
           pixel.y() <= height - 1 - border_px;
  }
};

// A camera parameter with its name: all except the image size.
using CameraParameter = Named<double Camera::*>;
// In the order of the members of Camera.
inline constexpr std::array<CameraParameter, 12> kCameraParameters = {
    {{"fx", &Camera::fx},
     {"fy", &Camera::fy},
     {"cx", &Camera::cx},
     {"cy", &Camera::cy},
     {"k1", &Camera::k1},
     {"k2", &Camera::k2},
     {"p1", &Camera::p1},
     {"p2", &Camera::p2},
     {"k3", &Camera::k3},
     {"k4", &Camera::k4},
     {"k5", &Camera::k5},
     {"k6", &Camera::k6}}};

// Every map has this many; the others are written only if they are used.
inline constexpr size_t kNumUsualParameters = 9;

// Errors of depth images, which sources correct.
struct DepthCorrection {
  // 1 / z = 1 / measured z + this, 1/m.
  double inverse_depth_offset = 0.0;

  // Maps a point X in the axes of the colour camera to its position according
  // to the depth image as registered to colour.
  Rigid3d depth_from_color = {};
};

// A camera with its exposure times and the unit, errors and noise of its depth.
struct RgbdCamera {
  Camera camera;                // of the colour image
  double depth_scale = 5000.0;  // raw units of the depth image per metre
  DepthCorrection depth_correction = {};  // of its errors
  Shutter color_shutter = {};             // relative to the colour timestamp
  Shutter depth_shutter = {};             // relative to the depth timestamp
  std::optional<DepthNoiseModel> depth_noise = {};  // nothing if unknown
};

// A camera by name: tum_fr1, tum_fr2, tum_fr3 (TUM RGB-D benchmark, calibration
// page; depth noise kinect), bonn (RGB-D Dynamic dataset), kinect, 7scenes,
// ros_default. Empty if the name is unknown.
std::optional<RgbdCamera> CameraPreset(std::string_view name);

// The names that CameraPreset knows.
std::vector<std::string> CameraPresetNames();

// A parameter of the camera's shutters with its name.
struct ShutterParameter {
  const char* name;            // as in camera files
  Shutter RgbdCamera::*image;  // the shutter
  double Shutter::*value;      // member of Shutter
  double most;                 // limit of the absolute value for any camera, s
};
// All of them, in the order of camera files.
inline constexpr std::array<ShutterParameter, 4> kShutterParameters = {
    {{"color_time_offset", &RgbdCamera::color_shutter, &Shutter::offset, 0.5},
     {"color_readout", &RgbdCamera::color_shutter, &Shutter::readout, 0.1},
     {"depth_time_offset", &RgbdCamera::depth_shutter, &Shutter::offset, 0.5},
     {"depth_readout", &RgbdCamera::depth_shutter, &Shutter::readout, 0.1}}};

}  // namespace rgbd_pose
