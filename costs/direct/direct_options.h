#pragma once

#include <string>

namespace rgbd_pose {

// How a direct cost selects its points.
struct DirectOptions {
  // Number of points at the finest level; 0: kMaxPoints of the cost. The image
  // is divided into about as many square cells; each gives at most one point.
  int max_points = 0;

  // Which pixels are used: limits in gray levels per pixel and in m.
  double min_gradient = 3.0;
  double min_depth = 0.3;
  double max_depth = 8.0;

  // Number of pyramid levels; if the images have fewer, the coarsest repeats.
  int num_levels = 4;
  // Pyramid level of the image used as the finest one. At 1, half the size,
  // interpolation does no harm to gray levels. Depths are of level 0.
  int finest_level = 1;

  // See MotionCost::information_factor; 0: kInformation of the cost.
  double information_factor = 0.0;

  // One line that describes the first invalid option, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
