#pragma once

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <optional>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/rigid3.h"

// OpenCV's PnP on our matches, the method most people would use instead.

namespace rgbd_pose {

// Previous points (m) and their pixels in the current image.
struct PnpInput {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  cv::Matx33d camera;

  explicit PnpInput(const Correspondences& matches)
      : camera(matches.camera().fx, 0, matches.camera().cx, 0,
               matches.camera().fy, matches.camera().cy, 0, 0, 1) {
    for (size_t i = 0; i < matches.size(); ++i) {
      const Eigen::Vector3d point = matches.Point(matches[i].prev);
      points.emplace_back(point.x(), point.y(), point.z());
      pixels.emplace_back(matches[i].cur.u, matches[i].cur.v);
    }
  }
};

// cur_from_prev by cv::solvePnPRansac with at most 500 samples, 3 px and a
// confidence of 0.999, optionally refined on the inliers by
// cv::solvePnPRefineLM. Nothing if OpenCV finds no pose.
inline std::optional<Rigid3d> SolvePnp(const PnpInput& input, bool refine) {
  cv::Mat rotation, translation;
  std::vector<int> inliers;
  cv::setRNGSeed(1);
  if (!cv::solvePnPRansac(input.points, input.pixels, input.camera,
                          cv::noArray(), rotation, translation, false, 500,
                          3.0F, 0.999, inliers)) {
    return std::nullopt;
  }
  if (refine) {
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (const int i : inliers) {
      points.push_back(input.points[i]);
      pixels.push_back(input.pixels[i]);
    }
    cv::solvePnPRefineLM(points, pixels, input.camera, cv::noArray(), rotation,
                         translation);
  }
  Eigen::Vector3d omega, t;
  cv::cv2eigen(rotation, omega);
  cv::cv2eigen(translation, t);
  return Rigid3d(Eigen::Quaterniond(
                     Eigen::AngleAxisd(omega.norm(), omega.stableNormalized())),
                 t);
}

}  // namespace rgbd_pose
