#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/lens.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/shutter.h"

namespace rgbd_pose {

// A pinhole camera with a lens (core/geometry/lens.h has the equations).
// Optical axes: x right, y down, z forward. Pixel (0, 0) is the centre of the
// upper left pixel. Lengths in pixels.
struct Camera {
  // Size of the image.
  int width = 640;
  int height = 480;

  // Focal lengths and principal point.
  double fx = 525.0;
  double fy = 525.0;
  double cx = 319.5;
  double cy = 239.5;

  // Distortion: radial k, tangential p; of an equidistant lens k1 to k4.
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;
  double k4 = 0.0;
  double k5 = 0.0;
  double k6 = 0.0;

  // What the coefficients mean.
  LensModel lens_model = LensModel::kRational;

  // One line that says what is wrong with the parameters, or empty.
  std::string Check() const;

  // One line that says what is unusual for an RGB-D camera, or empty: fx and fy
  // that differ by 5 %, a principal point that is a tenth of the image off its
  // middle. Both can be meant; more often numbers were exchanged or are those
  // of another size of image.
  std::string SanityWarning() const;

  // What the lens does, for coefficients of that type.
  template <typename S = double>
  Lens<S> MakeLens() const;

  // Whether the lens does anything: an equidistant one does without
  // coefficients, too.
  bool HasDistortion() const;

  // The coefficients in the order of OpenCV and ROS: k1 k2 p1 p2 k3, and k4 k5
  // k6 where one of them is not 0; of an equidistant lens k1 k2 k3 k4.
  std::vector<double> Distortion() const;

  // Takes 4, 5 or 8 of them, or more where those are 0; of an equidistant lens
  // 4. False, and nothing has changed, for another number.
  bool SetDistortion(LensModel model, const std::vector<double>& coefficients);

  // Image point (distorted px) of a point in camera axes; z must be > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& point) const;

  // How the image point of a place on the plane z = 1 moves with that place,
  // px.
  Eigen::Matrix2d ProjectDerivative(const Eigen::Vector2d& place) const;

  // Ideal pixel (the same fx, fy, cx, cy, no distortion) of an image pixel, to
  // 1e-10 px. NaN where there is none: beyond 90 degrees, or where the lens'
  // polynomial turns back.
  Eigen::Vector2d Undistort(const Eigen::Vector2d& pixel) const;

  // Undistorts many image points at once, in place.
  void UndistortPoints(std::vector<Eigen::Vector2d>* pixels) const;

  // The ray (a, b, 1) in camera axes of an ideal pixel: its point is depth
  // times as far.
  Eigen::Vector3d Ray(double u, double v) const {
    return {(u - cx) / fx, (v - cy) / fy, 1.0};
  }

  // Point in camera axes (m) of an image pixel (distorted) at a depth z (m).
  Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel, double depth) const;

  // Whether an image point is in the image, so far from its border.
  bool Contains(const Eigen::Vector2d& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px &&
           pixel.x() <= width - 1 - border_px &&
           pixel.y() <= height - 1 - border_px;
  }
};

// A number of a camera by its name: all but the size of the image.
struct CameraParameter {
  const char* name;       // as in Camera
  double Camera::*value;  // where it is
};

// In the order in which Camera has them.
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

// Those of them that every file of a camera has; the others where they are not
// 0.
inline constexpr size_t kNumUsualParameters = 9;

template <typename S>
Lens<S> Camera::MakeLens() const {
  using Factor = typename Lens<S>::Factor;
  Lens<S> lens;
  lens.k1 = S(k1);
  lens.k2 = S(k2);
  lens.p1 = S(p1);
  lens.p2 = S(p2);
  lens.k3 = S(k3);
  lens.k4 = S(k4);
  lens.k5 = S(k5);
  lens.k6 = S(k6);
  if (lens_model == LensModel::kEquidistant) {
    lens.factor = Factor::kEquidistant;
  } else if (k4 != 0.0 || k5 != 0.0 || k6 != 0.0) {
    lens.factor = Factor::kRational;
  } else if (HasDistortion()) {
    lens.factor = Factor::kPolynomial;
  }
  return lens;
}

// What is wrong with the depth images of a camera, to be undone as they are
// read (frontend/sources/frame_assembly.h).
struct DepthCorrection {
  // 1 / z = 1 / measured z + this, 1/m.
  double inverse_depth_offset = 0.0;

  // Where the depth image, as it was registered to colour, has a point X of the
  // axes of colour: this * X.
  Rigid3d depth_from_color = {};
};

// A camera together with how its depth images count, and when both images are
// taken.
struct RgbdCamera {
  Camera camera;                // of the colour image
  double depth_scale = 5000.0;  // raw units of the depth image per metre
  DepthCorrection depth_correction = {};  // what sources undo as they read
  Shutter color_shutter = {};             // from the stamp of colour
  Shutter depth_shutter = {};             // from the stamp of depth
};

// A camera known by name: tum_fr1, tum_fr2, tum_fr3, ros_default. Figures from
// the TUM RGB-D benchmark's calibration page. Empty if the name is unknown.
std::optional<RgbdCamera> CameraPreset(std::string_view name);

// The names that CameraPreset knows.
std::vector<std::string> CameraPresetNames();

// A number of a camera's shutters by its name.
struct ShutterParameter {
  const char* name;            // as camera files have it
  Shutter RgbdCamera::*image;  // whose it is
  double Shutter::*value;      // where it is
  double most;                 // no camera has more, either way, s
};
// All of them.
inline constexpr std::array<ShutterParameter, 4> kShutterParameters = {
    {{"color_time_offset", &RgbdCamera::color_shutter, &Shutter::offset, 0.5},
     {"color_readout", &RgbdCamera::color_shutter, &Shutter::readout, 0.1},
     {"depth_time_offset", &RgbdCamera::depth_shutter, &Shutter::offset, 0.5},
     {"depth_readout", &RgbdCamera::depth_shutter, &Shutter::readout, 0.1}}};

}  // namespace rgbd_pose
