#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {

struct VisibleFace;  // a face as seen by a camera

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

  // With a rolling shutter: each band of kBandRows rows, from the top, is
  // rendered at the time of its middle row. t is the time of the middle row of
  // the image. Without a readout (s) it is the time of all rows.
  static constexpr int kBandRows = 8;
  Rendering Render(const std::function<Rigid3d(double t)>& world_from_cam,
                   double t, double readout_s) const;

 private:
  // A block of the image and the range of its rays on the plane z = 1.
  struct Tile {
    cv::Rect pixels;
    Eigen::AlignedBox2f range;
  };

  std::vector<Tile> MakeTiles(int rows) const;
  void RenderTile(const std::vector<VisibleFace>& faces, const Tile& tile,
                  Rendering* out) const;

  Scene scene_;
  std::vector<SyntheticMover> movers_;
  cv::Mat rays_x_;  // CV_32FC1: where each pixel's ray meets the plane z = 1
  cv::Mat rays_y_;
  Eigen::Vector2f pixel_;  // size of a pixel on that plane
  std::vector<Tile> tiles_;
  std::vector<Tile> band_tiles_;  // each within one band
};

}  // namespace rgbd_pose
