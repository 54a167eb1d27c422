#pragma once

#include <Eigen/Geometry>
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

  // At time 0, which matters only to moving objects.
  Rendering Render(const Rigid3d& world_from_cam) const {
    return Render([&](double) { return world_from_cam; }, 0.0, 0.0);
  }

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
