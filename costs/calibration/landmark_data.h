#pragma once

#include <Eigen/Core>

#include "core/geometry/twist.h"

// What is measured of a landmark; landmark_model.h predicts it.

namespace rgbd_pose {

// An inverse depth measured at a pixel of a frame.
struct MeasuredInverseDepth {
  double value = 0.0;          // 1/m
  double inverse_sigma = 0.0;  // m; 0: not measured

  // The surface there: the plane m . X = z through its points X, where z is the
  // depth at this pixel and (a, b, 1) is the pixel's ray.
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();

  // The value of the nearest pixel alone and the ray of that pixel's centre, to
  // measure noise. 0: none.
  double pixel_value = 0.0;  // 1/m
  Eigen::Vector3d pixel_ray = Eigen::Vector3d::UnitZ();

  // The displacement of the depth camera that the image was corrected for.
  Eigen::Vector3d undone_rotation = Eigen::Vector3d::Zero();     // rad
  Eigen::Vector3d undone_translation = Eigen::Vector3d::Zero();  // m
};

// When a pixel of a keyframe is exposed, and the velocity of the camera.
struct RowMotion {
  Twist twist;
  double row = 0.0;  // as a share of the readout: -1/2 first, 1/2 last
};

// The measurements of a landmark at its anchor and in one view.
struct LandmarkData {
  double anchor_u = 0.0, anchor_v = 0.0;  // px, as seen (distorted)
  RowMotion anchor_motion;                // of that pixel
  double u = 0.0, v = 0.0;                // px, in the view
  RowMotion motion;                       // of u, v; or the anchor's
  double inverse_sigma_px = 0.0;          // of u and v
  MeasuredInverseDepth depth;             // of the view, or the anchor's
};

}  // namespace rgbd_pose
