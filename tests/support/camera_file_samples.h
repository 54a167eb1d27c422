#pragma once

#include <gtest/gtest.h>

#include <string>

namespace rgbd_pose {

// Typical camera files, shortened.
constexpr char kOrbSlam2[] =
    "%YAML:1.0\n"
    "\n"
    "# a comment\n"
    "Camera.fx: 517.3\n"
    "Camera.fy: 516.5\n"
    "Camera.cx: 318.6\n"
    "Camera.cy: 255.3\n"
    "Camera.k1: 0.2624\n"
    "Camera.k2: -0.9531\n"
    "Camera.p1: -0.0054\n"
    "Camera.p2: 0.0026\n"
    "Camera.k3: 1.1633\n"
    "Camera.width: 640\n"
    "Camera.height: 480\n"
    "Camera.fps: 30.0\n"
    "DepthMapFactor: 5208.0\n";

constexpr char kOrbSlam3[] =
    "%YAML:1.0\n"
    "---\n"
    "File.version: \"1.0\"\n"
    "Camera.type: \"PinHole\"\n"
    "Camera1.fx: 535.4\n"
    "Camera1.fy: 539.2\n"
    "Camera1.cx: 320.1\n"
    "Camera1.cy: 247.6\n"
    "Camera1.k1: 0.1\n"
    "Camera1.k2: 0.2\n"
    "Camera1.p1: 0.3\n"
    "Camera1.p2: 0.4\n"
    "Camera.width: 640\n"
    "Camera.height: 480\n"
    "RGBD.DepthMapFactor: 1000.0\n"
    "Tlr: !!opencv-matrix\n"
    "  rows: 1\n"
    "  cols: 2\n"
    "  dt: f\n"
    "  data: [1.0, 0.0]\n";

constexpr char kRos[] =
    "image_width: 320\n"
    "image_height: 240\n"
    "camera_name: rgb\n"
    "camera_matrix:\n"
    "  rows: 3\n"
    "  cols: 3\n"
    "  data: [270.5, 0, 160.25, 0, 271.5, 120.75, 0, 0, 1]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n"
    "  rows: 1\n"
    "  cols: 5\n"
    "  data: [0.01, 0.02, 0.03, 0.04, 0.05]\n";

constexpr char kKalibr[] =
    "cam0:\n"
    "  camera_model: pinhole\n"
    "  distortion_coeffs: [0.01, 0.02, 0.03, 0.04]\n"
    "  distortion_model: radtan\n"
    "  intrinsics: [600.5, 601.5, 424.25, 240.75]\n"
    "  resolution: [848, 480]\n"
    "  rostopic: /camera/color/image_raw\n"
    "cam1:\n"
    "  camera_model: omni\n";

// The text with its first `from` replaced; a failure without one.
inline std::string Replace(std::string text, const std::string& from,
                           const std::string& to) {
  const size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  if (place != std::string::npos) text.replace(place, from.size(), to);
  return text;
}

}  // namespace rgbd_pose
