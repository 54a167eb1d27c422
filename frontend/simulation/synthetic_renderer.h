#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {

// A face as seen by a camera. For the ray (x, y, 1) of a pixel in camera axes,
// face_from_ray * ray = (u, v, 1) / z: (u, v) is where the ray meets the plane
// of the face, z the depth there. This is linear in the ray, and the search for
// the nearest face takes only multiplications and comparisons.
struct VisibleFace {
  const SceneFace* face = nullptr;
  Eigen::Matrix3f face_from_ray;
  Eigen::Vector3f lamp;    // position along u, along v, above the face (m)
  Eigen::Vector3f camera;  // in the same axes
  Eigen::Vector2f min;     // range of the face on the plane z = 1;
  Eigen::Vector2f max;     // infinite if it reaches behind the camera
};

// The faces of a scene whose front is turned to the camera and which are not
// entirely behind it. The result points into `scene`.
std::vector<VisibleFace> FindVisibleFaces(const Scene& scene,
                                          const Rigid3d& world_from_cam);

// An independently moving object: its look, in axes and under a lamp of its
// own, and its pose at time t (s).
struct SyntheticMover {
  Scene scene;
  std::function<Rigid3d(double t)> world_from_mover;
};

// A printed sheet that moves with a camera on a path, 1 m in front of it,
// perpendicular to the optical axis and with the image's aspect ratio. It
// covers the share `share` of the view, above 0 and at most kMaxPatchShare, and
// moves on an ellipse at 5 to 8 px per frame (640 x 480 at 30 Hz; scales with
// the image size).
constexpr double kMaxPatchShare = 0.45;  // a larger one would leave the image
SyntheticMover MovingPatch(double share, const Camera& camera,
                           const std::function<Rigid3d(double t)>& path,
                           uint32_t seed);

// The first `count` of three printed boxes, as tall as children, that walk back
// and forth in the scene "room" at up to 0.9 m/s, through its furniture.
constexpr int kMaxWalkingBoxes = 3;
std::vector<SyntheticMover> WalkingBoxes(int count, uint32_t seed);

// What an ideal RGB-D camera sees.
struct Rendering {
  cv::Mat color;  // CV_8UC3, blue, green, red
  cv::Mat depth;  // CV_32FC1, z along the optical axis in metres; 0 = nothing
};

// Casts one ray per pixel into a scene. Depth is sampled at the pixel's centre
// in single precision. Colour is averaged over the pixel and slightly blurred,
// as by a lens. Render may be called from several threads at once; the result
// does not depend on the number of threads.
class Renderer {
 public:
  Renderer(Scene scene, const Camera& camera,
           std::vector<SyntheticMover> movers = {});

  // The time t (s) matters only to moving objects.
  Rendering Render(const Rigid3d& world_from_cam, double t = 0.0) const;

  // With a pose and a time for each band of kBandRows rows, from the top,
  // num_bands() in all, as a rolling shutter sees the scene.
  static constexpr int kBandRows = 8;
  int height() const { return rays_x_.rows; }  // of the image, px
  int num_bands() const { return (height() + kBandRows - 1) / kBandRows; }
  // The row in the middle of a band, px.
  double BandMiddle(int band) const {
    const int first = band * kBandRows;
    return (first + std::min(first + kBandRows, height()) - 1) / 2.0;
  }
  Rendering Render(const std::vector<StampedPose>& world_from_cam) const;

 private:
  // A block of the image and the range of its rays on the plane z = 1.
  struct Tile {
    cv::Rect pixels;
    Eigen::Vector2f min;
    Eigen::Vector2f max;
  };
  struct NearestFaces;

  std::vector<Tile> MakeTiles(int rows) const;
  NearestFaces FindNearest(const std::vector<VisibleFace>& faces,
                           const Tile& tile) const;
  void Shade(const std::vector<VisibleFace>& faces, const Tile& tile,
             const NearestFaces& nearest, Rendering* out) const;

  std::vector<VisibleFace> FindVisible(const StampedPose& pose) const;

  Scene scene_;
  std::vector<SyntheticMover> movers_;
  cv::Mat rays_x_;  // CV_32FC1: where each pixel's ray meets the plane z = 1
  cv::Mat rays_y_;
  Eigen::Vector2f pixel_;  // size of a pixel on that plane
  std::vector<Tile> tiles_;
  std::vector<Tile> band_tiles_;  // each within one band
};

}  // namespace rgbd_pose
