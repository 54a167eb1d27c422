#pragma once

#include <string>

#include "frontend/fusion/motion_filter.h"

namespace rgbd_pose {

// What users say of an export; each format takes what concerns it.
struct ExportOptions {
  std::string output;      // a file or a folder, as the format has it
  bool overwrite = false;  // a folder that is there

  // Which frames take part where images do.
  MotionFilter step;

  bool undistort = false;   // images, as of a pinhole camera
  double voxel = 0.01;      // of meshes and clouds, m
  double max_depth = 0.0;   // for these, m; 0: as the run, meshes 4 m
  int max_points = 200000;  // of clouds that come along with images
  int threads = 1;          // that read images ahead
};

}  // namespace rgbd_pose
