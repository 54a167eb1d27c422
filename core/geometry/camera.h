#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/geometry/shutter.h"

namespace rgbd_pose {

// A pinhole camera with OpenCV's plumb-bob distortion (k1 k2 p1 p2 k3).
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

  // Distortion: radial k, tangential p.
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;

  // One line that says what is wrong with the parameters, or empty.
  std::string Check() const;

  // One line that says what is unusual for an RGB-D camera, or empty: fx and fy
  // that differ by 5 %, a principal point that is a tenth of the image off its
  // middle. Both can be meant; more often numbers were exchanged or are those
  // of another size of image.
  std::string SanityWarning() const;

  // Whether any distortion coefficient is not 0.
  bool HasDistortion() const;

  // Image point (distorted px) of a point in camera axes; z must be > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& point) const;

  // Ideal pixel (the same fx, fy, cx, cy, no distortion) of an image pixel,
  // by fixed-point iteration (1e-10 px where the distortion is invertible).
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
inline constexpr std::array<CameraParameter, 9> kCameraParameters = {
    {{"fx", &Camera::fx},
     {"fy", &Camera::fy},
     {"cx", &Camera::cx},
     {"cy", &Camera::cy},
     {"k1", &Camera::k1},
     {"k2", &Camera::k2},
     {"p1", &Camera::p1},
     {"p2", &Camera::p2},
     {"k3", &Camera::k3}}};

// What is wrong with the depth images of a camera, to be undone as they are
// read (frontend/sources/corrected_source.h).
struct DepthCorrection {
  // 1 / z = 1 / measured z + this, 1/m.
  double inverse_depth_offset = 0.0;

  // Where the depth image, as it was registered to colour, has a point X of the
  // axes of colour: this * X.
  Rigid3d depth_from_color = {};

  // Whether there are none.
  bool IsIdentity() const {
    return inverse_depth_offset == 0.0 && depth_from_color.Angle() == 0.0 &&
           depth_from_color.translation.isZero(0.0);
  }
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

}  // namespace rgbd_pose
